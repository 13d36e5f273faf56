"""The pace of a simulated robot, and what may be asked of it."""

from pydantic import Field

from station.wire.base import RequestModel


class SimulationPatch(RequestModel):
    """Pause, resume, or change the pace; what is left out stays.

    Attributes:
        paused: Whether station time is to stand still.
        real_time_factor: Station time over wall time, 0.01 to 100.

    Example:
        {"paused": true}
    """

    paused: bool | None = None
    real_time_factor: float | None = None


class StepRequest(RequestModel):
    """Run some cycles of a paused simulation.

    Attributes:
        n: How many, 1 to 10000.

    Example:
        {"n": 100}
    """

    n: int = 1


class ResetRequest(RequestModel):
    """Put the world back to its start.

    Attributes:
        keyframe: Name of a pose to begin at; null for where the joints began.
        joint_positions: Joint name to position [rad] or [m]; the others go to the
            keyframe, or back to where they began.

    Example:
        {"keyframe": "ready", "joint_positions": {"panda_joint1": 0.5}}
    """

    keyframe: str | None = Field(default=None, min_length=1, max_length=128)

    joint_positions: dict[str, float] = Field(default_factory=dict)
