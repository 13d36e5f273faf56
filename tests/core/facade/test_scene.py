"""Roles are refused where a robot has no guard for them, by the robot's name."""

from types import SimpleNamespace

import pytest

from station.core.errors import ParameterError
from station.core.facade.scene import StationScene
from station.core.hardware.combined_robot_hw import CombinedRobotHW
from station.core.parameters import Parameters, ParameterTree
from station.hw.mock import MockRobotHW

BALL = {"name": "ball", "type": "sphere", "size": [0.1], "role": "keep_out"}


class Guarded(MockRobotHW):
    """Has a guard that counts what it was told."""

    def __init__(self):
        super().__init__()
        self.told = []

    def guards(self):
        def prepare(objects, _):
            return lambda: self.told.append([one.name for one in objects])

        return [
            SimpleNamespace(arm_id="arm", prepare=prepare, carry=lambda _: lambda: None)
        ]


def scene_of(*robots, **changes):
    """Return a scene with a ball around robots with the names r0, r1 and so on."""
    hw = robots[0]
    if len(robots) > 1:
        hw = CombinedRobotHW(MockRobotHW)
        for number, robot in enumerate(robots):
            hw.add_robot(f"r{number}", robot)
    loop = SimpleNamespace(hw=hw, run_in_cycle=lambda action: action())
    tree = ParameterTree({"scene": {"objects": [{**BALL, **changes}]}})
    return StationScene(loop, Parameters(tree), None, None)


def test_a_robot_without_a_guard_refuses_roles():
    with pytest.raises(ParameterError, match="this robot has no guard"):
        scene_of(MockRobotHW())
    with pytest.raises(ParameterError, match="'r1' has no guard"):
        scene_of(Guarded(), MockRobotHW())


def test_a_role_for_links_of_the_guarded_robot_is_taken():
    guarded = Guarded()
    scene_of(guarded, MockRobotHW(), links=["hand"])
    assert guarded.told == [["ball"]]
    scene_of(MockRobotHW(), role="object")
