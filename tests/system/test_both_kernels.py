"""Each default controller moves the arm alike, interpreted and compiled."""

import json
import os
import subprocess
import sys

import pytest

from station.compiled import SWITCH, find_misfit
from station.config import load_config
from tests.for_each import for_each
from tests.system.station_process import ROOT

pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(find_misfit() is not None, reason=str(find_misfit())),
]

SECONDS = 3
"""Of station time: a period of the set-points, two goals."""


@pytest.fixture(scope="module")
def modes():
    """Return what all controllers do, compiled and interpreted."""
    command = [sys.executable, "-m", "tests.system.motion_of_controllers", str(SECONDS)]
    return [
        json.loads(
            subprocess.run(
                command,
                cwd=ROOT,
                env={**os.environ, SWITCH: mode},
                stdout=subprocess.PIPE,
                check=True,
            ).stdout
        )
        for mode in ("1", "0")
    ]


def test_both_modes_have_run(modes):
    assert [one["mode"] for one in modes] == ["compiled", "interpreted"]


@for_each("controller", [*load_config().controllers])
def test_a_motion_is_the_same_in_every_bit(controller, modes):
    compiled, interpreted = (one["controllers"][controller] for one in modes)

    # Nothing was stopped: the whole motion is compared.
    assert {compiled["end"], interpreted["end"]} <= {"move running", "idle running"}
    assert len(compiled["seconds"]) == len(interpreted["seconds"]) == SECONDS
    pairs = zip(compiled["seconds"], interpreted["seconds"], strict=True)
    differing = [n for n, (one, other) in enumerate(pairs) if one != other]
    assert differing == []
