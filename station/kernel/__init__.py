"""The arithmetic of the control cycle: one source that runs interpreted or compiled."""
