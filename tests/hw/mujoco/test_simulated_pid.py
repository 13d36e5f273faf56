"""PID controllers inside the simulated robot."""

from math import pi

import pytest

from station.core.description.urdf import Joint, JointLimit, JointType, Pose
from station.core.errors import ParameterError
from station.core.numerics.pid import Pid, PidGains
from station.core.parameters import Parameters, ParameterTree
from station.hw.mujoco.joint_command_modes import SimulatedPid, read_simulated_pids


def joint(kind: JointType, limit: JointLimit | None = None) -> Joint:
    return Joint(
        name="j",
        type=kind,
        parent="a",
        child="b",
        origin=Pose(),
        axis=(0.0, 0.0, 1.0),
        limit=limit,
        damping=0.0,
        friction=0.0,
        mimic=None,
        safety=None,
    )


REVOLUTE = joint(JointType.REVOLUTE, JointLimit(-3.0, 3.0, 2.0, 50.0))
CONTINUOUS = joint(JointType.CONTINUOUS)
PRISMATIC = joint(JointType.PRISMATIC, JointLimit(0.0, 9.0, 2.0, 50.0))


@pytest.mark.parametrize(
    ("kind", "command", "position", "effort"),
    [
        (REVOLUTE, 1.0, 0.5, 5.0),
        # the short way would leave the range
        (REVOLUTE, 2.5, -2.5, 50.0),
        (CONTINUOUS, 2.5, -2.5, 10.0 * (5.0 - 2.0 * pi)),
        (PRISMATIC, 8.0, 4.0, 40.0),
    ],
)
def test_position_becomes_effort(kind, command, position, effort):
    pid = SimulatedPid(kind, Pid(PidGains(p=10.0)))
    assert pid.effort_for_position(command, position, 0.001) == pytest.approx(effort)


def test_velocity_becomes_effort_within_the_limit():
    pid = SimulatedPid(REVOLUTE, Pid(PidGains(p=10.0)))
    assert pid.effort_for_velocity(2.0, 0.5, 0.001) == 15.0
    assert pid.effort_for_velocity(-20.0, 0.0, 0.001) == -50.0


def test_reset_forgets_the_integral():
    pid = SimulatedPid(REVOLUTE, Pid(PidGains(i=1000.0, i_max=9.0, i_min=-9.0)))
    first = pid.effort_for_velocity(1.0, 0.0, 0.001)
    assert pid.effort_for_velocity(1.0, 0.0, 0.001) > first
    pid.reset()
    assert pid.effort_for_velocity(1.0, 0.0, 0.001) == first


def test_only_joints_with_gains_have_a_controller():
    params = Parameters(ParameterTree({"pid_gains": {"j": {"p": 1.0}}}))
    assert list(read_simulated_pids(params, {"j": REVOLUTE, "k": REVOLUTE})) == ["j"]


def test_gains_of_an_unknown_joint_are_refused():
    params = Parameters(ParameterTree({"pid_gains": {"elbow": {"p": 1.0}}}))
    with pytest.raises(ParameterError, match="pid_gains/elbow"):
        read_simulated_pids(params, {"j": REVOLUTE})
