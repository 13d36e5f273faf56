"""Layers that a browser can lay over the robots in the 3D view."""
