"""Wire models of goals."""

import pytest

from station.reports import examples_of
from station.wire import Goal, GoalRequest, TrajectoryRequest


@pytest.mark.parametrize("kind", [GoalRequest, TrajectoryRequest])
def test_examples_are_valid(kind):
    for example in examples_of(kind.__doc__):
        assert kind.model_validate(example)


def test_a_goal_under_way_has_no_result():
    text = (
        '{"id": "1", "status": "active", "progress": 0.5, "cancel_requested": false, '
        '"result": null}'
    )

    assert Goal.model_validate_json(text).result is None
