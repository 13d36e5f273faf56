"""A recording stepped again gives the same trajectory bit for bit, or says where."""

import json
import struct

import pytest

import station
from station.app import rerun as module
from station.core.control.hardware_components import ComponentState
from station.core.errors import RecordingFileError
from station.records import recording_reader

POSITION = "position_joint_trajectory_controller"
CRATE = {"name": "crate", "type": "box", "size": [0.1] * 3, "position": [0.0, 0.8, 0.3]}
EFFORT = "effort_group_position_controller"


def _move(robot):
    """Ask for everything that a re-run can ask again."""
    robot.move_to({"panda_joint1": 0.1}, duration=0.3)
    robot.facade.stop("a test")
    robot.run(0.05)
    robot.facade.release_stop(arm=False)
    robot.facade.release_stop(arm=True)
    robot.switch(start=[EFFORT])
    target = [*robot.latest().position[:7]]
    target[0] += 0.02
    robot.command(EFFORT, target)
    robot.run(0.1)
    gain = next(iter(robot.gains(EFFORT)))
    robot.set_gains(EFFORT, {gain: 300.0})
    robot.facade.loop.delay_next_cycle(3)
    robot.run(0.1)
    robot.reset()
    _change_the_scene(robot)
    robot.run(0.1)
    (component,) = robot.facade.manager.hardware_components()
    for state in (ComponentState.INACTIVE, ComponentState.ACTIVE):
        robot.facade.set_hardware_component_state(
            component.name, state, stop_controllers=True
        )
        robot.run(0.05)
    robot.switch(start=[EFFORT])
    robot.run(0.05)


def _move_in_a_chain(robot):
    """Command a chain of a slow controller and an asynchronous one."""
    robot.switch(start=["cascade", "inner"])
    robot.command("cascade", [0.3])
    robot.run(0.2)


def _change_the_scene(robot):
    """Move things while the arm moves towards them, which slows it."""
    scene = robot.facade.surroundings
    ball = {"type": "sphere", "size": [0.1], "position": [0.6, 0.5, 0.6]}
    scene.put("ball", {**ball, "role": "keep_out"})
    scene.put("cup", {"type": "sphere", "size": [0.02], "role": "keep_out"})
    scene.attach("cup", load=False)
    names = [f"panda_joint{k}" for k in range(1, 8)]
    point = {"positions": [0.9, *robot.latest().position[1:7]], "time_from_start": 1.0}
    robot.switch(start=[POSITION], stop=[EFFORT])
    request = {"trajectory": {"joint_names": names, "points": [point]}}
    robot.facade.motion.submit_goal(POSITION, request)
    robot.run(0.5)
    scene.put("ball", {"position": [0.3, 0.35, 0.5]})
    robot.run(0.4)
    assert scene.clearance("panda").interventions > 0
    scene.put("crate", {"position": [0.0, 0.7, 0.3]})
    scene.replace_roles([{**ball, "name": "dot", "role": "keep_out"}])
    scene.detach("cup", load=False)
    scene.remove("dot")


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    """Return the file of a recording of all inputs."""
    with (
        station.open({"scene": {"objects": [CRATE]}}) as robot,
        robot.record(tmp_path_factory.mktemp("recordings"), "all") as path,
    ):
        _move(robot)
    return path


def test_a_re_run_is_the_same_bit_for_bit(recording):
    found = module.rerun(recording)

    assert found.is_equal, found.text()
    assert found.cycles > 600
    assert found.not_repeated == ()
    assert found.text() == f"Equal: {found.cycles} cycles are the same, bit for bit."


CHAIN = """
robot:
  type: mock_hw/MockRobotHW
  joints: [j1]
  is_async: true
  async_parameters: {cycles: 2}
controllers:
  inner:
    type: pid_controller/PidController
    dof_names: [j1]
    command_interface: effort
    reference_and_state_interfaces: [velocity]
    gains: {j1: {p: 10.0, i: 1.0}}
    update_rate: 500
  cascade:
    type: velocity_controllers/JointGroupVelocityController
    joints: [inner/j1]
    is_async: true
    async_parameters: {cycles: 3, process: true}
    update_rate: 250
start: []
"""


def test_rates_chains_and_what_is_asynchronous_run_again_bit_for_bit(tmp_path):
    config = tmp_path / "station.yaml"
    config.write_text(CHAIN)
    with (
        station.open(config=config) as robot,
        robot.record(tmp_path, "chain") as path,
    ):
        _move_in_a_chain(robot)

    found = module.rerun(path)

    assert found.is_equal, found.text()
    velocity = recording_reader.read_trajectory(path).velocity[:, 0]
    assert 0.01 < velocity[-1] <= 0.3


def test_the_first_difference_is_told(recording, monkeypatch):
    original = recording_reader.read_trajectory(recording)
    last_bit = struct.unpack("<d", struct.pack("<q", 1))[0]
    cycle = int(original.cycle[400])
    value = original.position[400, 2]
    original.position[400, 2] = value + abs(value) * 2.0**-52 + last_bit
    monkeypatch.setattr("station.app.rerun.read_trajectory", lambda _: original)

    found = module.rerun(recording)

    assert not found.is_equal
    assert (found.difference.cycle, found.difference.joint) == (cycle, "panda_joint3")
    assert found.difference.rerun == value
    assert f"Different from cycle {cycle} on" in found.text()
    assert json.loads(json.dumps(found.as_json()))["is_equal"] is False


def test_another_input_makes_a_difference(recording, monkeypatch):
    inputs = recording_reader.read_inputs(recording)
    changed = [
        {**one, "changes": {EFFORT: {next(iter(one["changes"][EFFORT])): 301.0}}}
        if one["kind"] == "gains"
        else one
        for one in inputs
    ]
    monkeypatch.setattr("station.app.rerun.read_inputs", lambda _: changed)

    assert not module.rerun(recording).is_equal


def test_what_cannot_be_asked_again_is_named(recording, monkeypatch):
    inputs = recording_reader.read_inputs(recording)
    inputs.append({"after": 50, "kind": "operation", "what": "a push of the arm"})
    monkeypatch.setattr("station.app.rerun.read_inputs", lambda _: inputs)

    (named,) = module.rerun(recording).not_repeated
    assert named == "Cannot be asked again: a push of the arm, after cycle 50."


def test_a_recording_without_all_inputs_is_refused(recording, monkeypatch):
    lacking = [{"kind": "begin", "is_whole": False}]
    monkeypatch.setattr("station.app.rerun.read_inputs", lambda _: lacking)

    with pytest.raises(RecordingFileError, match="cannot be run again"):
        module.rerun(recording)


def test_a_file_that_is_not_there_is_refused(tmp_path):
    with pytest.raises(RecordingFileError, match=r"none\.mcap cannot be read: No such"):
        module.rerun(tmp_path / "none.mcap")


def test_the_fixture_of_users_passes(recording, rerun):
    assert rerun(recording).is_equal


def test_the_fixture_of_users_fails_at_a_difference(recording, rerun, monkeypatch):
    changed = recording_reader.read_trajectory(recording)
    changed.position[10, 0] += 1.0
    monkeypatch.setattr("station.app.rerun.read_trajectory", lambda _: changed)

    with pytest.raises(pytest.fail.Exception, match="panda_joint1"):
        rerun(recording)


def _live(robot):
    """Move while cycles run in their thread: goals replaced, cancelled, set-points."""
    trajectory = "position_joint_trajectory_controller"
    names = [f"panda_joint{n}" for n in range(1, 8)]

    def point(offset, seconds):
        positions = [*ready]
        positions[0] += offset
        return {"positions": positions, "time_from_start": seconds}

    def send(*points):
        goal = {"trajectory": {"joint_names": names, "points": [*points]}}
        return robot.facade.motion.submit_goal(trajectory, goal)

    robot.move_to({"panda_joint1": 0.1}, duration=0.3)
    ready = [*robot.latest().position[:7]]
    for offset in (0.05, -0.05, 0.1):
        goal = send(point(offset / 2, 0.2), point(offset, 0.4))
        robot.run(0.12)
    robot.facade.motion.cancel_goal(trajectory, goal.identifier)
    robot.run(0.1)
    robot.facade.motion.follow_trajectory(
        trajectory, {"joint_names": names, "points": [point(0.0, 0.3)]}
    )
    robot.run(0.1)
    robot.facade.motion.hold(trajectory)
    robot.run(0.1)
    robot.switch(start=[EFFORT], stop=[trajectory])
    for step in range(5):
        target = [*robot.latest().position[:7]]
        target[0] += 0.01 * step
        robot.facade.motion.set_command(EFFORT, target, timeout=0.05)
        robot.run(0.03)
    robot.run(0.2)  # the last set-point expires
    robot.facade.motion.set_command(EFFORT, target)
    robot.run(0.1)
    robot.facade.motion.let_go([EFFORT], "Control was lost.")
    robot.run(0.1)


@pytest.mark.alone
@pytest.mark.slow
def test_a_live_recording_runs_again_bit_for_bit(tmp_path):
    with (
        station.open(threaded=True) as robot,
        robot.record(tmp_path, "live") as path,
    ):
        _live(robot)

    kinds = {one["kind"] for one in recording_reader.read_inputs(path)}
    assert {"goal", "trajectory", "cancel_goal", "set_point", "expire"} <= kinds
    found = module.rerun(path)

    assert found.is_equal, found.text()
    assert found.not_repeated == ()
