"""Read recordings and incidents as the script or the motion of a trial."""

from pathlib import Path

import numpy as np

from station.core.errors import suggest
from station.records.cycle_messages import CONTROLLERS, CYCLES, JOINT_STATES
from station.records.recording_reader import read_messages
from station.records.recording_table import Columns, columns
from station.trials.errors import ExperimentError
from station.trials.trace import Array, Trace
from station.trials.trial import Script
from station.wire.excitations import MOST_RECORDED, Recorded

SUFFIX = ".mcap"
"""Ending of the name of a recording's file."""
_SAMPLE = 20
"""Cycles between two values of a motion without jumps."""
_FASTEST = 10.0
"""Speed of a set-point above which it counts as a jump [rad/s or m/s]."""
_NOTHING = 1e-9
"""Smaller offsets of positions come from rounding [rad or m]."""
_JOINTS = f"{JOINT_STATES.strip('/')}/"
_POSITION = f"{_JOINTS}position/"


def recorded_script(path: Path, controller: str) -> Script:
    """Return a controller's recorded requests as a script.

    The script has the set-points of the longest time in which the controller ran
    without a gap, a reset or a stop. It begins at the positions of the joints at that
    time, at rest. Forces on the robot are not recorded, so the script has none.

    Args:
        path: The file of a recording or an incident.
        controller: The controller.

    Raises:
        RecordingFileError: The file is not a complete recording.
        ExperimentError: The controller did not run in the recording, or its set-points
            are not those of joints.
    """
    wanted = f"{CONTROLLERS}{controller}"
    table = columns(path, [CYCLES, JOINT_STATES, wanted])
    start = f"{wanted.strip('/')}/desired/"
    names = [name.removeprefix(start) for name in table if name.startswith(start)]
    if not names:
        ran = {
            topic for topic, _ in read_messages(path) if topic.startswith(CONTROLLERS)
        }
        raise ExperimentError(
            f"Controller '{controller}' had no set-points in {path}.",
            remedy=suggest(
                controller, sorted(topic.removeprefix(CONTROLLERS) for topic in ran)
            ),
            details={"controller": controller},
        )
    desired = np.column_stack([table[f"{start}{name}"] for name in names])
    rows = _longest_run(table, desired)
    begin = {
        name.removeprefix(_POSITION): float(table[name][rows][0])
        for name in table
        if name.startswith(_POSITION)
    }
    period = float(np.median(table["period"][rows]))
    offsets = np.empty_like(desired[rows])
    is_smooth = True
    for column, name in enumerate(names):
        if name not in begin:
            raise ExperimentError(
                f"The set-point of '{controller}' has '{name}', which is no joint.",
                remedy="A script moves joints; choose a controller of joints.",
            )
        values = desired[rows, column]
        measured = table[f"{start.replace('/desired/', '/actual/')}{name}"][rows]
        # The measured quantity that the controller compares with a set-point tells its
        # kind.
        is_position = np.array_equal(measured, table[f"{_POSITION}{name}"][rows])
        jump = np.abs(np.diff(values)).max(initial=0.0)
        is_smooth = is_smooth and is_position and jump <= _FASTEST * period
        offsets[:, column] = values - begin[name] if is_position else values
    offsets[np.abs(offsets) < _NOTHING] = 0.0
    return Script(
        controller=controller,
        duration=len(offsets) * period,
        commands=tuple(
            _command(name, values, period, is_smooth=is_smooth)
            for name, values in zip(names, offsets.T, strict=True)
            if values.any()
        ),
        begin=begin,
    )


def recorded_trace(path: Path) -> Trace:
    """Return the measured motion of all joints in a recording.

    Args:
        path: The file of a recording or an incident. If it has gaps or resets, the
            longest part without them is read.

    Raises:
        RecordingFileError: The file is not a complete recording.
        ExperimentError: The recording has no cycle in which all joints were measured.
    """
    table = columns(path, [CYCLES, JOINT_STATES])
    names = [name.removeprefix(_POSITION) for name in table if _POSITION in name]
    shape = (len(table["cycle"]), len(names))
    position, velocity, effort = (
        np
        .array([table[f"{_JOINTS}{quantity}/{name}"] for name in names])
        .reshape(shape[::-1])
        .T
        for quantity in ("position", "velocity", "effort")
    )
    rows = _longest_run(table, position)
    period = float(np.median(table["period"][rows]))
    unknown: Array = np.full_like(position[rows], np.nan)
    return Trace(
        tuple(names),
        period,
        period * np.arange(len(unknown), dtype=np.float64),
        *(position[rows], velocity[rows], effort[rows]),
        *(unknown, unknown, unknown),
    )


def _longest_run(table: Columns, wanted: Array) -> slice:
    """Return the longest run of cycles without a gap, a new epoch or a missing number.

    Args:
        table: The recording.
        wanted: Numbers that must be present, with NaN for a missing number, shape (k,
            n).

    Raises:
        ExperimentError: There is no usable cycle.
    """
    usable = ~np.isnan(wanted.sum(axis=1))
    begins = np.diff(table["cycle"], prepend=np.nan) != 1.0
    begins |= np.diff(table["epoch"], prepend=np.nan) != 0.0
    best = slice(0, 0)
    first = 0
    for row, (is_usable, is_begin) in enumerate(
        zip(usable.tolist(), begins.tolist(), strict=True)
    ):
        if not is_usable or is_begin:
            first = row if is_usable else row + 1
        if row + 1 - first > best.stop - best.start:
            best = slice(first, row + 1)
    if best.stop == 0:
        raise ExperimentError("The recording has no cycle that could be used.")
    return best


def _command(joint: str, offsets: Array, period: float, *, is_smooth: bool) -> Recorded:
    """Return the recorded offsets of a joint.

    Args:
        joint: The joint.
        offsets: Offset in each cycle [unit of the set-point], shape (k,).
        period: Time between two cycles [s].
        is_smooth: Whether the offsets form a smooth curve; otherwise every jump is
            kept.

    Raises:
        ExperimentError: There are too many values.
    """
    if is_smooth:
        chosen = np.arange(0, len(offsets), _SAMPLE)
    else:
        chosen = np.flatnonzero(np.diff(offsets, prepend=0.0))
    if len(chosen) > MOST_RECORDED:
        raise ExperimentError(
            f"The set-point of '{joint}' has {len(chosen)} values; allowed are "
            f"{MOST_RECORDED}.",
            remedy="Record a shorter time.",
        )
    return Recorded(
        joint=joint,
        times=tuple((chosen * period).tolist()),
        values=tuple(offsets[chosen].tolist()),
        between="smooth" if is_smooth else "hold",
    )
