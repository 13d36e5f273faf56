"""A server for clients of ROS: rosbridge v2 with rosapi, over WebSockets."""
