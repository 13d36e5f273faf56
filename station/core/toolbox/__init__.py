"""Tools of control_toolbox and realtime_tools for controllers that users write."""
