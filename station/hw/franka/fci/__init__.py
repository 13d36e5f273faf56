"""The Franka Control Interface: messages between libfranka and a robot."""
