"""One PID per joint: names, units and ranges of the gains."""

import pytest

from station.controllers.set_point_controller import JointPidGroup, JointQuantity
from station.core.description.robot_description import JointDescription
from station.core.description.urdf import JointType
from station.core.errors import ParameterError
from station.core.numerics.pid import PidGains
from station.core.parameters import Parameters, ParameterTree
from station.memory.doubles import put, zeros

ELBOW = JointDescription("elbow", JointType.REVOLUTE)
SLIDE = JointDescription("slide", JointType.PRISMATIC)
POSITION, VELOCITY, EFFORT = JointQuantity


@pytest.mark.parametrize(
    ("joint", "error", "command", "units"),
    [
        (ELBOW, POSITION, EFFORT, ["Nm/rad", "Nm/(rad s)", "Nm s/rad", "Nm"]),
        (SLIDE, POSITION, EFFORT, ["N/m", "N/(m s)", "N s/m", "N"]),
        (ELBOW, POSITION, VELOCITY, ["1/s", "1/s^2", "", "rad/s"]),
        (ELBOW, VELOCITY, EFFORT, ["Nm s/rad", "Nm/rad", "Nm s^2/rad", "Nm"]),
    ],
)
def test_units_follow_from_error_and_command(joint, error, command, units):
    schema = JointPidGroup([joint], [PidGains()], error=error, command=command)
    names = [f"{joint.name}/{key}" for key in ("p", "i", "d", "i_clamp_max")]
    assert [schema.tunables.schema[name].unit for name in names] == units


def test_commands_are_computed_joint_by_joint():
    pids = JointPidGroup(
        [ELBOW, SLIDE],
        [PidGains(p=2.0), PidGains(i=3.0, i_max=9.0, i_min=-9.0)],
        error=POSITION,
        command=EFFORT,
    )
    put(pids.errors, [0.5, 0.1])
    for step in range(1, 3):
        pids.group.compute_commands(0.1, rates_known=False)
        assert list(pids.commands) == pytest.approx([1.0, 0.03 * step])
    pids.reset()
    pids.group.compute_commands(0.1, rates_known=False)
    assert list(pids.commands) == pytest.approx([1.0, 0.03])


@pytest.mark.parametrize(
    ("change", "part"),
    [
        ({"elbow/i": 4.0}, 2.0),
        ({"elbow/i": 0.5}, 2.0),
        ({"elbow/i_clamp_max": 8.0}, 2.0),
        ({"elbow/i_clamp_max": 1.0}, 1.0),
        ({"elbow/i": 1e-320}, 0.0),
        ({"elbow/i": 0.0}, 0.0),
    ],
)
@pytest.mark.parametrize("antiwindup", [False, True])
def test_a_change_of_gains_keeps_the_integral_part_of_the_command(
    change, part, antiwindup
):
    pids = JointPidGroup(
        [ELBOW],
        [PidGains(i=2.0, i_max=2.0, i_min=-2.0, antiwindup=antiwindup)],
        error=POSITION,
        command=EFFORT,
    )
    put(pids.errors, [1.0])
    for _ in range(30):  # far beyond the bound, which wound-up integrals are
        pids.group.compute_commands(0.1, rates_known=False)
    pids.tunables.apply(pids.tunables.checked(change))
    put(pids.errors, [0.0])
    pids.group.compute_commands(0.1, rates_known=False)
    assert list(pids.commands) == pytest.approx([part])


def test_an_integral_gain_that_was_0_begins_without_a_step():
    pids = JointPidGroup(
        [ELBOW], [PidGains(i_max=9.0, i_min=-9.0)], error=POSITION, command=EFFORT
    )
    put(pids.errors, [1.0])
    for _ in range(30):
        pids.group.compute_commands(0.1, rates_known=False)
    pids.tunables.apply(pids.tunables.checked({"elbow/i": 2.0}))
    pids.group.compute_commands(0.1, rates_known=False)
    assert list(pids.commands) == pytest.approx([0.2])


def test_commands_are_written_where_the_robot_reads_them():
    commands = zeros(1)
    pids = JointPidGroup(
        [ELBOW], [PidGains(d=2.0)], error=POSITION, command=EFFORT, commands=commands
    )
    put(pids.errors, [0.5])
    put(pids.rates, [3.0])
    pids.group.compute_commands(0.1, rates_known=True)
    assert list(commands) == [6.0]


def test_gains_go_in_and_come_out_by_name():
    pids = JointPidGroup([ELBOW], [PidGains(p=1.0)], error=POSITION, command=EFFORT)
    wanted = {
        "elbow/p": 1.0,
        "elbow/i": 2.0,
        "elbow/d": 3.0,
        "elbow/i_clamp_max": 4.0,
        "elbow/i_clamp_min": -5.0,
    }
    pids.tunables.apply(pids.tunables.checked(wanted))
    assert pids.tunables.values == wanted
    assert pids.columns()["i_clamp"] == [4.0]
    put(pids.errors, [0.5])
    pids.group.compute_commands(0.1, rates_known=False)
    assert list(pids.commands) == pytest.approx([0.5 + 2.0 * 0.05 + 3.0 * 5.0])


def test_the_gains_of_a_group_are_not_taken_from_a_single_pid_block():
    params = Parameters(ParameterTree({"arm": {"pid": {"p": 1.0}}}), "arm")
    with pytest.raises(ParameterError, match="'arm/elbow/pid/p' is missing"):
        PidGains.of_joints(params, ["elbow", "slide"])


@pytest.mark.parametrize(
    ("gains", "told"),
    [
        (PidGains(p=1.0, i=5.0), True),
        (PidGains(p=1.0, i=5.0, antiwindup=True), True),
        (PidGains(p=1.0, i=5.0, i_max=1.0, i_min=-1.0), False),
        (PidGains(p=1.0, i=5.0, i_max=1.0), False),
        (PidGains(p=1.0), False),
    ],
)
def test_an_integral_gain_without_a_bound_is_told_to_have_no_effect(gains, told):
    pids = JointPidGroup([ELBOW], [gains], error=POSITION, command=EFFORT)
    notes = pids.tunables.notes(pids.tunables.values)
    assert len(notes) == told
    assert all("'elbow/i' is 5 and has no effect" in note for note in notes)
