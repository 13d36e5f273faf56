"""What a station was asked for in a recording, asked again in a trial."""

import numpy as np
import pytest

from station.app.in_process import InProcessStation
from station.core.errors import RecordingFileError
from station.experiments.identification import identify
from station.experiments.recordings import recorded_script, recorded_trace
from station.records.recording_table import columns
from station.trials.errors import ExperimentError
from station.trials.trial import Trial
from tests.experiments.conftest import GROUP

TRAJECTORY = "effort_joint_trajectory_controller"
VELOCITY = "velocity_group_controller"
JOINTS = [f"panda_joint{number}" for number in range(1, 8)]


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    """Record 0.3 s of three controllers, one after the other."""
    folder = tmp_path_factory.mktemp("records")
    settings = {"robot.realism": "ideal"}
    with InProcessStation(settings=settings) as station, station.record(folder) as path:
        target = list(station.positions().values())
        motion = station.facade.motion
        station.switch(start=[GROUP])
        station.run(0.1)
        for way in (0.1, -0.15, 0.1):
            target[0] += way
            motion.set_command(GROUP, target)
            station.run(0.2)
        station.switch(start=[TRAJECTORY], stop=[GROUP])
        target[1] += 0.05
        rest = {"velocities": 7 * [0.0], "accelerations": 7 * [0.0]}
        point = {"positions": target, **rest, "time_from_start": 0.25}
        request = {"joint_names": JOINTS, "points": [point]}
        motion.follow_trajectory(TRAJECTORY, request)
        station.run(0.3)
        station.switch(start=[VELOCITY], stop=[TRAJECTORY])
        motion.set_command(VELOCITY, [0.1] + 6 * [0.0])
        station.run(0.3)
    return path


def recorded(path, controller):
    """Return desired and measured positions of the cycles of a controller."""
    table = columns(path)
    desired, measured = (
        np.column_stack([table[f"{start}/{joint}"] for joint in JOINTS])
        for start in (f"controllers/{controller}/desired", "joint_states/position")
    )
    ran = np.isfinite(desired[:, 0])
    return desired[ran], measured[ran]


@pytest.mark.parametrize(
    ("controller", "between", "moved", "tolerance"),
    [
        # The bounds: where joints were moving when the controller began, the trial
        # begins at rest.
        (GROUP, "hold", ["panda_joint1"], 1e-6),
        (TRAJECTORY, "smooth", JOINTS, 3e-3),
        (VELOCITY, "hold", ["panda_joint1"], 1e-3),
    ],
)
def test_what_was_asked_for_is_asked_for_again(
    recording, world, panda, controller, between, moved, tolerance
):
    script = recorded_script(recording, controller)
    result, trace = world.record(Trial(panda, script))

    assert [command.joint for command in script.commands if any(command.values)] == [
        joint for joint in JOINTS if joint in moved
    ]
    assert {command.between for command in script.commands} == {between}
    assert result.state == "done", result.reason
    desired, measured = recorded(recording, controller)
    assert len(trace.desired) == len(desired)
    # The cycle in which a set-point arrives may differ by one.
    near = np.abs(trace.desired[2:] - desired[1:-1]).max(axis=1) < tolerance
    assert near.mean() > 0.98
    assert np.abs(trace.position - measured).max() < tolerance


def test_motion_of_a_recording_is_identified(recording):
    trace = recorded_trace(recording)

    table = columns(recording)
    assert trace.joints == tuple(JOINTS)
    assert trace.period == pytest.approx(0.001)
    assert len(trace.time) == len(table["cycle"])
    assert np.array_equal(
        trace.velocity[:, 0], table["joint_states/velocity/panda_joint1"]
    )
    assert identify(trace, "panda_joint1").inertia.value > 0.1


def test_controller_that_did_not_run_is_refused_by_name(recording, tmp_path):
    with pytest.raises(
        ExperimentError, match="'position_group_controller' had no set-"
    ):
        recorded_script(recording, "position_group_controller")
    (tmp_path / "no.mcap").write_text("no recording")
    with pytest.raises(RecordingFileError, match=r"no\.mcap cannot be read"):
        recorded_script(tmp_path / "no.mcap", GROUP)
