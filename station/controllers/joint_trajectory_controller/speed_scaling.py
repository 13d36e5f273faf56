"""Scale the speed at which a trajectory is executed, down to a pause."""

from collections.abc import Mapping

from station.core.control.tunables import Tunable, Tunables
from station.core.declared_parameter import DeclaredParameter, ParameterType
from station.core.parameters import Parameters

SPEED_SCALING = DeclaredParameter(
    name="speed_scaling",
    type=ParameterType.NUMBER,
    default=1.0,
    minimum=0.0,
    maximum=1.0,
    description="speed of the executed trajectory; 0 pauses",
)
"""The factor, which is a run-time parameter, too."""
_RAMP = DeclaredParameter(
    name="speed_scaling_ramp",
    type=ParameterType.NUMBER,
    unit="s",
    default=0.5,
    minimum=0.0,
    description="time from standstill to full speed",
)
SPEED_PARAMETERS = (SPEED_SCALING, _RAMP)
"""The parameters of the speed scaling."""


class SpeedScaling:
    """A factor between 0 and 1 that changes at a limited rate.

    Args:
        target: First target, and the first factor.
        ramp_time: Time from standstill to full speed [s], >= 0.

    Attributes:
        target: The factor that is approached, 0 to 1.
        factor: The present factor, 0 to 1: trajectory time that passes per real time.
        rate: Rate at which the factor changes [1/s].
        tunables: The target as the run-time parameter `speed_scaling`.
    """

    def __init__(self, target: float = 1.0, ramp_time: float = 0.5) -> None:
        self.target = target
        self.factor = target
        self.rate = 0.0
        self._ramp_time = ramp_time
        text = "speed of the trajectory; 0 pauses, 1 is as planned"
        self.tunables = Tunables(
            {SPEED_SCALING.name: Tunable("", 0.0, 1.0, text)},
            {SPEED_SCALING.name: target},
            apply=self._set_target,
        )

    @classmethod
    def from_parameters(cls, params: Parameters) -> "SpeedScaling":
        """Return the scaling that `speed_scaling` and `speed_scaling_ramp` describe.

        Args:
            params: The controller's namespace.

        Raises:
            ParameterError: A parameter is out of its range.
        """
        return cls(SPEED_SCALING.read_float(params), _RAMP.read_float(params))

    def advance(self, period: float) -> float:
        """Move the factor towards its target; return the trajectory time passed [s].

        Args:
            period: Time since the last cycle [s], >= 0.
        """
        if self.factor == self.target:
            self.rate = 0.0
            return period * self.factor
        before = self.factor
        step = period / self._ramp_time if self._ramp_time > 0.0 else 1.0
        difference = self.target - before
        if abs(difference) <= step:
            self.factor = self.target
        else:
            self.factor = before + (step if difference > 0.0 else -step)
        self.rate = (self.factor - before) / period if period > 0.0 else 0.0
        return period * 0.5 * (before + self.factor)

    def _set_target(self, values: Mapping[str, float]) -> None:
        self.target = values[SPEED_SCALING.name]
