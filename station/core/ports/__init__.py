"""Ports: how other threads hand set-points and goals to a controller."""
