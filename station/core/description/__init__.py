"""Robot descriptions: the one reader of URDF and SRDF, and where their files are."""
