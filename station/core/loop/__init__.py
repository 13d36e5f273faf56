"""The control thread: cycles, snapshots, the stop, operations between cycles."""
