"""Control station: ros_control in Python, with a simulated robot and a web API."""

__version__ = "0.1.0"
