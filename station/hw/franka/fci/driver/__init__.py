"""The client's side of the Franka Control Interface: an arm behind the network."""
