"""The channels of a recording, live, for Foxglove and other clients of its protocol."""
