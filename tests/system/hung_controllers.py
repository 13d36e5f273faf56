"""Controllers that do not return, each in its own way."""

import ctypes
import re
import time
from pathlib import Path

from station.core.control.controller import Controller
from station.core.hardware.interfaces import PositionJointInterface

_C = ctypes.PyDLL(None)
"""C functions called so that they keep the interpreter lock."""


class _HangingController(Controller[PositionJointInterface]):
    hardware_interface = PositionJointInterface

    def init(self, interface, params):
        """Take the joint; hang `after` s after the start."""
        self._joint = interface.get_handle("joint1")
        self._after = params.get_float("after", 0.3)
        self._seconds = params.get_float("seconds", 600.0)
        self._begin = 0.0

    def starting(self, time):
        self._begin = time

    def update(self, time, period):
        if time - self._begin > self._after:
            self.hang()
            # What a controller writes when it comes back late must not reach a robot
            # that was stopped meanwhile.
            self._joint.set_command(1.5)

    def hang(self):
        """Do not return for long."""


class EndlessController(_HangingController):
    """Loops for ever; other threads get the interpreter in between."""

    def hang(self):
        while True:
            pass


class LockedController(_HangingController):
    """Waits in C with the interpreter lock held: no other thread runs."""

    def hang(self):
        for _ in range(int(self._seconds * 10)):
            _C.usleep(100_000)


class DeepController(_HangingController):
    """Waits in one C call with the interpreter lock held for `seconds`."""

    def hang(self):
        _C.usleep(int(self._seconds * 1e6))


class BacktrackingController(_HangingController):
    """Matches a regular expression that needs exponential time, in C."""

    def hang(self):
        re.fullmatch("(a*)*b", "a" * 60)


class NeverLoadedController(_HangingController):
    """Does not return from `init`; makes the file `mark`, if that is given, before."""

    def init(self, interface, params):
        """Wait for ever."""
        if params.has("mark"):
            Path(params.get_str("mark")).touch()
        while True:
            time.sleep(1.0)
