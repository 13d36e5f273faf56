"""A fault to plant: a gate that lets every command through."""

import pytest

from station.core.control import controller_lifecycle
from station.core.control.command_gate import CommandGate


class OpenGate(CommandGate):
    """Neither puts commands back nor lets them rest."""

    def keep_commands(self):
        """Write nothing."""

    def note_owners(self, loaded):
        """Write nothing."""


@pytest.fixture
def open_gate(monkeypatch):
    """Open the gate of the robots that are made from now on."""
    monkeypatch.setattr(controller_lifecycle, "CommandGate", OpenGate)
