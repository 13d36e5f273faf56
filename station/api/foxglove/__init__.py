"""The channels of a recording, live, for Foxglove and whoever speaks its protocol."""
