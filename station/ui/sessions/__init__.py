"""Who has logged in, what they may do, and who holds control."""
