"""The mode that is said to run is the one that runs, to the same results."""

import math
import os
import subprocess
import sys

import pytest

from station.compiled import SWITCH, status
from station.hw.mujoco.world_step import SpeedCheck
from station.memory import functions
from tests.both_modes import needs_both

PRINT_RESULTS = """
from station.compiled import status
from station.memory import functions
values = [0.0, 5e-324, 0.1, 1.0, 2.0, 3.0, 1e8, 1e300]
names = ["square_root", "sine", "cosine"]
print(status().mode)
print([getattr(functions, name)(value).hex() for name in names for value in values])
"""


def run_python(mode):
    result = subprocess.run(
        [sys.executable, "-c", PRINT_RESULTS],
        env={**os.environ, SWITCH: mode},
        capture_output=True,
        text=True,
        check=True,
    )
    return result.stdout.splitlines()


def test_modules_are_those_that_the_status_tells():
    ending = ".so" if status().is_compiled else ".py"

    assert functions.__file__.endswith(ending)


def test_functions_return_what_the_standard_library_does():
    assert functions.square_root(2.0) == math.sqrt(2.0)
    assert functions.sine(0.3) == math.sin(0.3)
    assert functions.cosine(0.3) == math.cos(0.3)


@pytest.mark.skipif(not status().is_compiled, reason=status().text())
def test_both_modes_return_the_same_bits():
    (mode, compiled), (other_mode, interpreted) = run_python("1"), run_python("0")

    assert (mode, other_mode) == ("compiled", "interpreted")
    assert compiled == interpreted


@needs_both
def test_a_view_in_a_compiled_object_takes_a_line_of_the_cache():
    # Two views, a number, and what every object has.
    assert SpeedCheck.__basicsize__ <= 2 * 64 + 40
