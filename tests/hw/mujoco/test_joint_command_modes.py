"""Which command a joint obeys."""

from math import nan, pi

import pytest

from station.core.description.urdf import Joint, JointLimit, JointType, Pose
from station.core.errors import ParameterError
from station.core.hardware.interfaces import (
    EffortJointInterface,
    PositionJointInterface,
)
from station.core.hardware.robot_hw import ControllerInfo, InterfaceResources
from station.core.hardware.transmissions import RawJointData
from station.core.numerics.pid import Pid, PidGains
from station.core.parameters import Parameters, ParameterTree
from station.hw.mujoco.joint_command_modes import (
    JointCommandModes,
    SimulatedPid,
    read_simulated_pids,
)
from station.hw.mujoco.joint_drives import DriveMode

WHEEL = Joint(
    name="b",
    type=JointType.CONTINUOUS,
    parent="x",
    child="y",
    origin=Pose(),
    axis=(0.0, 0.0, 1.0),
    limit=None,
    damping=0.0,
    friction=0.0,
    mimic=None,
    safety=None,
)


class Bench:
    """Two joints, `a` at 1 rad and `b` at 2 rad; `b` has a PID controller."""

    def __init__(self):
        self.joints = RawJointData()
        for name in ("a", "b"):
            self.joints.add(name)
        self.joints.position[:] = [1.0, 2.0]
        self.joints.velocity[:] = [0.0, 0.0]
        self.drives = [DriveMode.POSITION] * 2
        pids = {"b": SimulatedPid(WHEEL, Pid(PidGains(p=10.0)))}
        self.modes = JointCommandModes(self.joints, pids, self.drives)
        self.modes.restart()


def info(interface, *joints):
    claims = (InterfaceResources(interface.type_name, joints),)
    return [ControllerInfo("c", "test/C", claims)]


@pytest.fixture
def bench():
    return Bench()


def test_unclaimed_joint_is_held_where_it_came_to_rest(bench):
    bench.joints.velocity[0] = 1.0
    bench.modes.command_joints(0.001)
    bench.joints.position[0] = 1.1
    bench.joints.velocity[0] = 0.0
    bench.modes.command_joints(0.001)
    bench.joints.position[0] = 1.2
    bench.modes.command_joints(0.001)
    assert bench.joints.position_command == [1.1, 2.0]
    assert bench.drives == [DriveMode.POSITION] * 2
    assert bench.modes.in_use == []


def test_claimed_joint_obeys_the_interface_it_is_claimed_through(bench):
    start = info(EffortJointInterface, "a")
    bench.joints.effort_command[0] = 9.0
    bench.modes.switch(start, [])
    assert bench.drives == [DriveMode.EFFORT, DriveMode.POSITION]
    assert bench.modes.in_use == [("a", "effort")]
    assert bench.modes.quantities == ["effort", "position"]
    assert bench.joints.effort_command[0] == 0.0
    bench.modes.switch([], start)
    assert bench.drives == [DriveMode.POSITION] * 2


def test_joint_with_gains_is_driven_by_effort(bench):
    bench.modes.switch(info(PositionJointInterface, "b"), [])
    bench.joints.position_command[1] = 2.5
    bench.modes.command_joints(0.001)
    assert bench.drives[1] is DriveMode.EFFORT
    assert bench.joints.effort_command[1] == pytest.approx(5.0)


def test_joint_that_stays_in_its_mode_keeps_its_command(bench):
    first = info(PositionJointInterface, "a")
    bench.modes.switch(first, [])
    bench.joints.position_command[0] = 1.7
    bench.modes.switch(info(PositionJointInterface, "a"), first)
    assert bench.joints.position_command[0] == 1.7


def test_command_that_is_no_number_frees_the_joint(bench):
    bench.modes.switch(info(EffortJointInterface, "a", "b"), [])
    bench.joints.effort_command[0] = nan
    assert bench.modes.release_bad_commands()
    assert bench.modes.in_use == [("b", "effort")]
    assert not bench.modes.release_bad_commands()


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
