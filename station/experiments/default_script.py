"""Scripts for who has none: small motions of all joints of a controller."""

from collections.abc import Sequence

from station.experiments.trial_world import TrialWorld
from station.trials.errors import ExperimentError
from station.trials.script import Script
from station.wire.excitations import Waypoints

_WAY = 0.1
"""How far a joint goes, if a tenth of its range is not less [rad or m]."""
_TIMES = (0.4, 0.8, 1.2, 1.5)
_SHARES = (2.0, 0.0, 1.0, 0.0)
_DURATION = 2.0


def default_script(world: TrialWorld, controller: str) -> Script:
    """Return a script of 2 s in which all joints move to and fro, and rest.

    Raises:
        ExperimentError: The controller commands no positions of joints.
        StationError: It is not loaded.
    """
    motions = small_motions(world, controller, _TIMES, _SHARES)
    if not motions:
        raise ExperimentError(
            f"Controller '{controller}' commands no positions of joints, so that it is "
            "not known what a motion of it would be.",
            remedy="Give a --script; docs/experiments.md lists its commands.",
        )
    return Script(controller=controller, duration=_DURATION, commands=motions)


def small_motions(
    world: TrialWorld, controller: str, times: Sequence[float], shares: Sequence[float]
) -> tuple[Waypoints, ...]:
    """Return a motion of each joint of a controller, away from the nearest limit.

    Args:
        world: Where the controller is loaded.
        controller: Its name.
        times: When the waypoints are reached [s], > 0 and increasing, shape (k,).
        shares: Where they are, in steps of 0.1 rad or m or of a tenth of the range of
            the joint if that is less, shape (k,).

    Returns:
        One motion per joint; none when the controller commands no positions of joints.

    Raises:
        StationError: The controller is not loaded.
    """
    world.gains(controller)  # refuses a controller that is not loaded
    found = world.station.facade.manager.get_controller(controller)
    joints = list(found.joint_names)
    positions = world.begin_positions
    if found.trajectories is None:
        elements = () if found.set_points is None else found.set_points.elements
        if not elements or any(
            e.unit not in {"rad", "m"} or e.name not in joints for e in elements
        ):
            return ()
    if any(joint not in positions for joint in joints):
        return ()
    limits = {r.joint: r.limits for r in world.station.facade.loop.hw.joint_limits()}
    motions = []
    for joint in joints:
        low = high = None
        if joint in limits:
            low, high = limits[joint].min_position, limits[joint].max_position
        way = _WAY
        if low is not None and high is not None:
            way = min(_WAY, 0.1 * (high - low))
            way = -way if positions[joint] > 0.5 * (low + high) else way
        values = tuple(share * way for share in shares)
        motions.append(Waypoints(joint=joint, times=tuple(times), values=values))
    return tuple(motions)
