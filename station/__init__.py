"""Control station: ros_control in Python, a simulated robot behind it, a web API before it."""

__version__ = "0.1.0"
