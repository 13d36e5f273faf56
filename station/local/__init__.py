"""The stations on this machine: how programs of their user find them, with tokens."""
