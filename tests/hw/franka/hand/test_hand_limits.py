"""What may be asked of a hand."""

from math import nan

import pytest

from station.core.errors import InvalidCommandError
from station.core.franka import GraspRequest
from station.hw.franka.hand.hand_limits import (
    FASTEST,
    MAX_FORCE,
    OPEN_WIDTH,
    WEAKEST,
    check_grasp,
    check_move,
)


@pytest.mark.parametrize("width", [0.0, 0.03, OPEN_WIDTH])
def test_every_width_of_the_hand_is_allowed(width):
    check_move("panda", width, FASTEST, OPEN_WIDTH)


@pytest.mark.parametrize(
    ("width", "speed", "field"),
    [
        (-0.001, 0.1, "width"),
        (0.081, 0.1, "width"),
        (nan, 0.1, "width"),
        (0.05, 0.0, "speed"),
        (0.05, 1.01 * FASTEST, "speed"),
    ],
)
def test_impossible_move_is_refused_with_its_field(width, speed, field):
    with pytest.raises(InvalidCommandError, match=f"was given '{field}'") as error:
        check_move("panda", width, speed, OPEN_WIDTH)
    (told,) = error.value.details["errors"]
    assert told["field"] == f"body/{field}"


@pytest.mark.parametrize("force", [WEAKEST, MAX_FORCE])
def test_every_force_of_the_hand_is_allowed(force):
    check_grasp("panda", GraspRequest(0.03, force), OPEN_WIDTH)


@pytest.mark.parametrize(
    ("values", "field"),
    [
        ({"width": OPEN_WIDTH}, "width"),
        ({"force": 0.0}, "force"),
        ({"force": 2.0 * MAX_FORCE}, "force"),
        ({"speed": nan}, "speed"),
        ({"epsilon_inner": -1.0}, "epsilon/inner"),
        ({"epsilon_outer": nan}, "epsilon/outer"),
    ],
)
def test_impossible_grasp_is_refused_with_its_field(values, field):
    request = GraspRequest(**{"width": 0.03, "force": 20.0, **values})
    with pytest.raises(InvalidCommandError) as error:
        check_grasp("panda", request, OPEN_WIDTH)
    (told,) = error.value.details["errors"]
    assert told["field"] == f"body/{field}"
