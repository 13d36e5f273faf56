"""A minute of each default controller is the same, interpreted and compiled."""

import os
import subprocess
import sys

import pytest

from station.compiled import SWITCH, find_misfit
from station.config import load_config
from tests.system.station_process import ROOT

pytestmark = pytest.mark.slow

MINUTE = 60
PROGRAM = "tests.system.minute_of_a_controller"


def lines_of(controller, mode):
    result = subprocess.run(
        [sys.executable, "-m", PROGRAM, controller, str(MINUTE)],
        cwd=ROOT,
        env={**os.environ, SWITCH: mode},
        stdout=subprocess.PIPE,
        text=True,
        check=True,
    )
    return result.stdout.splitlines()


@pytest.mark.skipif(find_misfit() is not None, reason=str(find_misfit()))
@pytest.mark.parametrize("controller", [*load_config().controllers])
def test_a_minute_is_the_same_in_every_bit(controller):
    (mode, *compiled, end), (other_mode, *interpreted, other_end) = (
        lines_of(controller, which) for which in ("1", "0")
    )

    assert (mode, other_mode) == ("compiled", "interpreted")
    # Nothing was stopped: a whole minute of motion is compared.
    assert {end, other_end} <= {"move running", "idle running"}
    assert len(compiled) == len(interpreted) == MINUTE
    pairs = enumerate(zip(compiled, interpreted, strict=True))
    assert [second for second, (one, other) in pairs if one != other] == []
