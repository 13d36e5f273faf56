"""Limits of a robot's joints: where they come from, and that they act."""

from math import inf

import pytest

from station.core.description.urdf_parser import parse_urdf
from station.core.hardware.interfaces import JointHandle, JointStateHandle
from station.core.hardware.limits import JointLimitsError, LimitMode
from station.core.parameters import Parameters, ParameterTree
from station.hw.mujoco.joint_command_limits import JointCommandLimits

SAFETY = (
    '<safety_controller soft_lower_limit="-0.9" soft_upper_limit="0.9" '
    'k_position="10" k_velocity="5"/>'
)
EFFORT = "hardware_interface::EffortJointInterface"


class Bench:
    """One joint at rest in the middle of -1 to 1 rad."""

    def __init__(self, *, mode=LimitMode.ROS_CONTROL, soft="", velocity=2, **entry):
        xml = (
            '<robot name="r"><link name="a"/><link name="b"/>'
            '<joint name="j" type="revolute"><parent link="a"/><child link="b"/>'
            f'<limit lower="-1" upper="1" effort="5" velocity="{velocity}"/>{soft}'
            "</joint></robot>"
        )
        values = {"joint_limits": {"j": entry}} if entry else {}
        params = Parameters(ParameterTree(values))
        self.limits = JointCommandLimits(parse_urdf(xml).joints, params, mode)
        self.position, self.velocity = [0.0], [0.0]
        state = JointStateHandle("j", self.position, self.velocity, [0.0])
        self.commands = {q: [0.0] for q in ("position", "velocity", "effort")}
        self.limits.add(
            "j", {q: JointHandle(state, c) for q, c in self.commands.items()}
        )

    def give(self, quantity: str, command: float) -> float:
        self.limits.activate([("j", quantity)])
        self.commands[quantity][0] = command
        self.limits.enforce(0.001)
        return self.commands[quantity][0]


def test_limits_come_from_the_urdf():
    (report,) = Bench(soft=SAFETY).limits.reports
    assert report.limits.max_position == 1.0
    assert report.soft_limits.k_position == 10.0
    assert report.sources == {
        "position": "urdf limit",
        "velocity": "urdf limit",
        "effort": "urdf limit",
        "soft": "urdf safety_controller",
    }


def test_parameters_win():
    entry = {"has_velocity_limits": True, "max_velocity": 0.5}
    (report,) = Bench(**entry, has_effort_limits=False).limits.reports
    assert report.limits.max_velocity == 0.5
    assert report.limits.max_effort is None
    assert report.sources == {"position": "urdf limit", "velocity": "parameters"}


@pytest.mark.parametrize("quantity", ["position", "velocity", "effort"])
@pytest.mark.parametrize("mode", list(LimitMode))
@pytest.mark.parametrize("soft", ["", SAFETY])
def test_far_commands_are_limited_and_reported(quantity, mode, soft):
    bench = Bench(mode=mode, soft=soft)
    allowed = {"position": 2.0 * 0.001, "velocity": 2.0, "effort": 5.0}[quantity]
    assert bench.limits.clamps() == []
    assert bench.give(quantity, 1e3) == pytest.approx(allowed)
    (clamp,) = bench.limits.clamps()
    assert clamp.hardware_interface.lower().endswith(f"{quantity}jointinterface")
    assert (clamp.count, clamp.last.asked, clamp.last.joint) == (1, 1e3, "j")


def test_only_commands_in_use_are_limited():
    bench = Bench()
    bench.commands["effort"][0] = 1e3
    bench.give("position", 0.0)
    assert bench.commands["effort"][0] == 1e3


def test_velocity_of_0_in_the_urdf_is_no_limit():
    bench = Bench(velocity=0)
    assert bench.limits.reports[0].limits.max_velocity is None
    assert bench.give("velocity", 1e3) == 1e3


def test_contradictory_parameters_are_refused():
    entry = {"has_position_limits": True, "min_position": 1.0, "max_position": -1.0}
    with pytest.raises(JointLimitsError, match="'j'"):
        Bench(**entry)


def test_reset_starts_from_the_measured_position():
    bench = Bench()
    bench.give("position", 0.5)
    bench.position[0] = 0.3
    bench.limits.reset()
    assert bench.give("position", 1.0) == pytest.approx(0.302)
    assert inf > bench.limits.clamps()[0].count > 1
