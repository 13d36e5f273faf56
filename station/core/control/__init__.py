"""Controllers and the manager that loads, switches and updates them."""
