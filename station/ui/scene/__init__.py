"""The robots in 3D, and the layers over them."""
