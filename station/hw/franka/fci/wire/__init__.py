"""The messages of the Franka Control Interface as bytes; no sockets, no arm."""
