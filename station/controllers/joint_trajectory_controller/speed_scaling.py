"""Scale the speed at which a trajectory is executed, down to a pause."""

from collections.abc import Mapping

from station.controllers.joint_trajectory_controller.trajectory_update import (
    SpeedFactor,
)
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


class SpeedScaling(SpeedFactor):
    """A factor between 0 and 1 that changes at a limited rate.

    Args:
        target: First target, and the first factor.
        ramp_time: Time from standstill to full speed [s], >= 0.

    Attributes:
        tunables: The target as the run-time parameter `speed_scaling`.
    """

    def __init__(self, target: float = 1.0, ramp_time: float = 0.5) -> None:
        super().__init__(target, ramp_time)
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

    def _set_target(self, values: Mapping[str, float]) -> None:
        self.target = values[SPEED_SCALING.name]
