"""The robots in 3D, and what a browser can lay over them."""
