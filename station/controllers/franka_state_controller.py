"""Publish the whole state of an arm at a fixed rate.

Source: franka_ros@c11f000 franka_control/src/franka_state_controller.cpp; differs: the
last publication is kept as one object for any thread, instead of being sent to topics.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace

from typing_extensions import override

from station.controllers.franka_arm import (
    ARM_ID,
    JOINT_NAMES,
    read_arm_id,
    read_arm_joints,
)
from station.core.control.controller import PUBLISH_RATE, Controller, JointStates
from station.core.franka import FrankaStateHandle, FrankaStateInterface, RobotState
from station.core.franka.franka_errors import error_names
from station.core.franka.franka_robot_state import PackedState
from station.core.parameters import Parameters
from station.core.toolbox.publish_timer import PublishTimer

_PUBLISH_RATE = replace(
    PUBLISH_RATE, default=30.0, description="rate at which the state is published"
)
_ERRORS = ("current_errors", "last_motion_errors")


@dataclass(frozen=True, slots=True)
class FrankaStates:
    """The content of one publication.

    Attributes:
        sequence: Number of the publication, starting at 0.
        stamp: Station time [s].
        state: A copy of the whole state.
        joint_states: Measured positions, velocities and torques.
        joint_states_desired: Desired positions, velocities and torques.
        F_ext: Wrench in the stiffness frame `<arm_id>_K` [N, Nm], shape (6,).
        transforms: Parent, child and pose of the child in the parent, for the frames
            at the flange.
    """

    sequence: int
    stamp: float
    state: RobotState
    joint_states: JointStates
    joint_states_desired: JointStates
    F_ext: list[float]
    transforms: tuple[tuple[str, str, list[float]], ...]


class FrankaStateController(Controller[FrankaStateInterface]):
    """Publishes the state of one arm; commands nothing.

    Parameters: `arm_id`; `joint_names`, 7 names; `publish_rate` [Hz], 30 by default.
    """

    own_parameters = (ARM_ID, JOINT_NAMES, _PUBLISH_RATE)

    @override
    def init(self, interface: FrankaStateInterface, params: Parameters) -> None:
        self._arm_id = read_arm_id(params)
        self.joint_names = read_arm_joints(params)
        self._timer = PublishTimer(_PUBLISH_RATE.read_float(params))
        self._handle: FrankaStateHandle = interface.get_handle(f"{self._arm_id}_robot")
        # Number, time and state of the last publication, and what was made of it.
        self._newest: tuple[int, float, PackedState] | None = None
        self._made: tuple[object, FrankaStates | None] = (None, None)
        self._sequence = 0

    @override
    def starting(self, time: float) -> None:
        self._timer.start(time, at_once=True)

    @override
    def update(self, time: float, period: float) -> None:
        """Publish when a publication is due."""
        if not self._timer.is_due(time):
            return
        packed = self._handle.get_robot_state().packed()
        self._newest = (self._sequence, time, packed)
        self._sequence += 1

    @property
    def franka_states(self) -> FrankaStates | None:
        """The last publication, one object until the next one; None before the first.

        Any thread may ask. The object is made by the caller, not in the control loop.
        """
        newest, made = self._newest, self._made
        if newest is None or made[0] is not newest:
            made = (newest, None if newest is None else self._publication(*newest))
            self._made = made
        return made[1]

    def _publication(
        self, sequence: int, time: float, packed: PackedState
    ) -> FrankaStates:
        state = RobotState.unpacked(packed)
        names, prefix = self.joint_names, self._arm_id
        return FrankaStates(
            sequence=sequence,
            stamp=time,
            state=state,
            joint_states=JointStates(time, names, state.q, state.dq, state.tau_J),
            joint_states_desired=JointStates(
                time, names, state.q_d, state.dq_d, state.tau_J_d
            ),
            F_ext=state.K_F_ext_hat_K,
            transforms=(
                (f"{prefix}_link8", f"{prefix}_NE", state.F_T_NE),
                (f"{prefix}_NE", f"{prefix}_EE", state.NE_T_EE),
                (f"{prefix}_EE", f"{prefix}_K", state.EE_T_K),
            ),
        )

    @override
    def published(self) -> Mapping[str, Mapping[str, object]]:
        """Return the original's topics: state, joints, wrench and transforms."""
        found = self.franka_states
        if found is None:
            return {}
        return {
            "franka_states": {
                "stamp": found.stamp,
                "sequence": found.sequence,
                **_as_message(found.state),
            },
            "joint_states": found.joint_states._asdict(),
            "joint_states_desired": found.joint_states_desired._asdict(),
            "F_ext": {
                "stamp": found.stamp,
                "frame_id": f"{self._arm_id}_K",
                "force": found.F_ext[:3],
                "torque": found.F_ext[3:],
            },
            "tf": {
                "transforms": [
                    {"frame_id": parent, "child_frame_id": child, "pose": pose}
                    for parent, child, pose in found.transforms
                ]
            },
        }


def _as_message(state: RobotState) -> dict[str, object]:
    """Return the fields of a state; mode and errors are given by name."""
    message: dict[str, object] = {
        one.name: getattr(state, one.name) for one in fields(state)
    }
    message["robot_mode"] = state.robot_mode.name.lower()
    for name in _ERRORS:
        message[name] = error_names(getattr(state, name))
    return message
