"""The Franka Control Interface: what libfranka and a robot say to each other."""
