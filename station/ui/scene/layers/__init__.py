"""What a browser can lay over the robots in the 3D view, each thing by itself."""
