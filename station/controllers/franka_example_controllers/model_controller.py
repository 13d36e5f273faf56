"""Evaluate the model of an arm, and keep the results.

Source: franka_ros@c11f000 franka_example_controllers,
src/model_example_controller.cpp; differs: the values are kept for any thread to
read instead of being logged.
"""

from dataclasses import dataclass

from typing_extensions import override

from station.controllers.franka_arm import ARM_ID, read_arm_id
from station.core.control.controller import Controller
from station.core.franka import Frame, FrankaModelHandle, FrankaModelInterface
from station.core.parameters import Parameters
from station.core.toolbox.publish_timer import PublishTimer

RATE_HZ = 1.0
"""How often the model is evaluated."""


@dataclass(frozen=True, slots=True)
class ModelSample:
    """One evaluation of the model; matrices are column-major.

    Attributes:
        stamp: Station time [s].
        mass: Mass matrix [kg m^2], shape (49,).
        coriolis: Coriolis torques [Nm], shape (7,).
        gravity: Gravity torques [Nm], shape (7,).
        pose: Pose of joint 4 in the base frame, shape (16,).
        body_jacobian: Body Jacobian of joint 4, shape (42,).
        zero_jacobian: Zero Jacobian of the end effector, shape (42,).
    """

    stamp: float
    mass: list[float]
    coriolis: list[float]
    gravity: list[float]
    pose: list[float]
    body_jacobian: list[float]
    zero_jacobian: list[float]


class ModelExampleController(Controller[FrankaModelInterface]):
    """Evaluates the model once a second; commands nothing.

    Parameters: `arm_id`.

    Attributes:
        model_sample: The last evaluation, a new object each time; None before that.
    """

    own_parameters = (ARM_ID,)

    @override
    def init(self, interface: FrankaModelInterface, params: Parameters) -> None:
        name = f"{read_arm_id(params)}_model"
        self._model: FrankaModelHandle = interface.get_handle(name)
        self._timer = PublishTimer(RATE_HZ)
        self.model_sample: ModelSample | None = None

    @override
    def starting(self, time: float) -> None:
        self._timer.start(time, at_once=True)

    @override
    def update(self, time: float, period: float) -> None:
        if not self._timer.is_due(time):
            return
        model = self._model
        self.model_sample = ModelSample(
            time,
            model.get_mass(),
            model.get_coriolis(),
            model.get_gravity(),
            model.get_pose(Frame.JOINT4),
            model.get_body_jacobian(Frame.JOINT4),
            model.get_zero_jacobian(Frame.END_EFFECTOR),
        )
