"""The accelerometers of an arm: two on the board of each joint but the last.

libfranka reports them from 0.18 on and says no more than that. Where the boards are is
taken from the frames `linkN_accelerometer_top` and `linkN_accelerometer_bottom` of the
URDF that libfranka tests with; the first board, of joint 1, stands in the base. A
reading is the acceleration of the frame's origin less that of gravity, in the axes of
the frame, as a sensor with a mass on springs has it: at rest 9.81 m/s^2 upwards. The
sign that a real arm reports is not published.

Source: libfranka@0.20.4 test/fr3.urdf; include/franka/robot_state.h,
RobotState.accelerometer_top, accelerometer_bottom.
"""

from collections.abc import Iterable
from math import pi

from station.core.description.urdf import Pose, Vector3
from station.core.franka.franka_robot_state import RobotState
from station.core.franka.joint_memory import JointMemory
from station.core.numerics.arm_chain import (
    measure_accelerations,
    new_links,
    place_links,
)
from station.hw.franka.arm.franka_kinematics import CHAIN
from station.hw.franka.simulated.end_effector import as_transform
from station.memory.doubles import Doubles, doubles, put, zeros

# Place [m] in the frames of the links 0 to 5, and the turn about x from there [rad].
_TOP: tuple[tuple[Vector3, float], ...] = (
    ((0.0, 0.0, 0.05), pi),
    ((0.0, -0.1, 0.0), pi / 2),
    ((0.0, -0.13, 0.0), -pi / 2),
    ((0.0825, 0.05, 0.0), -pi / 2),
    ((-0.0825, 0.05, 0.0), pi / 2),
    ((0.0, 0.11, 0.0), -pi / 2),
)
_BOTTOM: tuple[tuple[Vector3, float], ...] = (
    ((0.0, 0.0, 0.06), 0.0),
    ((0.0, -0.09, 0.0), -pi / 2),
    ((0.0, -0.14, 0.0), pi / 2),
    ((0.0825, 0.04, 0.0), pi / 2),
    ((-0.0825, 0.06, 0.0), -pi / 2),
    ((0.0, 0.1, 0.0), pi / 2),
)


class Accelerometers:
    """Computes the readings of an arm's accelerometers when they are asked for.

    The accelerations of the joints are differences of velocities since the last
    reading. So the first reading is one of joints that do not accelerate, and who reads
    every cycle gets the accelerations of that cycle. Control thread only.

    Args:
        state: The arm's state.
        memory: The positions and velocities of its joints as they are.
    """

    def __init__(self, state: RobotState, memory: JointMemory) -> None:
        self._state = state
        self._memory = memory
        self._gravity = state.doubles("O_ddP_O")
        self._links = new_links(CHAIN)
        self._boards = _poses(_TOP), _poses(_BOTTOM)
        self._readings = zeros(3 * len(_TOP)), zeros(3 * len(_BOTTOM))
        self._last, self._ddq = zeros(memory.size), zeros(memory.size)
        self._seen: float | None = None

    def read(self) -> tuple[Doubles, Doubles]:
        """Return the readings on top and bottom of the boards [m/s^2], each 6 x 3.

        The memory is the same at every call.
        """
        memory, time = self._memory, self._state.time
        elapsed = 0.0 if self._seen is None else time - self._seen
        if self._seen is not None and elapsed <= 0.0:
            return self._readings
        for i in range(memory.size):
            change = memory.dtheta[i] - self._last[i]
            self._ddq[i] = change / elapsed if elapsed else 0.0
        put(self._last, memory.dtheta)
        self._seen = time
        place_links(CHAIN, memory.positions, self._links)
        motion = self._links, memory.dtheta, self._ddq, self._gravity
        for boards, readings in zip(self._boards, self._readings, strict=True):
            measure_accelerations(*motion, boards, readings)
        return self._readings

    def forget(self) -> None:
        """Begin anew: the arm has been put elsewhere."""
        self._seen = None


def _poses(boards: Iterable[tuple[Vector3, float]]) -> Doubles:
    return doubles(
        number
        for place, turn in boards
        for number in as_transform(Pose.from_rpy(place, (turn, 0.0, 0.0)))
    )
