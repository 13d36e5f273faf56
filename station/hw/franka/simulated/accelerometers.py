"""The accelerometers of an arm: two on the board of each joint but the last.

libfranka reports them from version 0.18 on, without further information. The places of
the boards are those of the frames `linkN_accelerometer_top` and
`linkN_accelerometer_bottom` in the URDF of libfranka's tests; the first board, of joint
1, is in the base. A reading is the acceleration of the frame's origin minus that of
gravity, in the axes of the frame, as a mass on springs measures it: at rest 9.81 m/s^2
upwards. The sign that a real arm reports is not published.

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
from station.memory.doubles import Doubles, doubles, own, zeros

# Place [m] in the frames of the links 0 to 5, and the rotation about x [rad].
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
    """Computes the readings of an arm's accelerometers on request.

    The accelerations of the joints are differences of velocities since the last
    reading. So the first reading assumes joints that do not accelerate, and a reader of
    every cycle gets the accelerations of each cycle. Control thread only.

    Args:
        state: The arm's state.
        memory: True positions and velocities of the arm's joints.
    """

    def __init__(self, state: RobotState, memory: JointMemory) -> None:
        self.state = state
        self.memory = memory
        self.gravity = state.doubles("O_ddP_O")
        self.chain = own(CHAIN)
        self.links = own(new_links(CHAIN))
        self.top, self.bottom = own(_poses(_TOP)), own(_poses(_BOTTOM))
        self.readings = zeros(3 * len(_TOP)), zeros(3 * len(_BOTTOM))
        self.top_readings, self.bottom_readings = self.readings
        none = [0.0] * memory.size
        self.last, self.ddq = own(none), own(none)
        self.has_read = False
        self.seen = 0.0

    def read(self) -> tuple[Doubles, Doubles]:
        """Return the top and bottom readings of the boards [m/s^2], each 6 x 3.

        The memory is the same at every call.
        """
        memory = self.memory
        time = self.state.time
        elapsed = time - self.seen if self.has_read else 0.0
        if self.has_read and elapsed <= 0.0:
            return self.readings
        for i in range(memory.size):
            change = memory.dtheta[i] - self.last[i]
            self.last[i] = memory.dtheta[i]
            self.ddq[i] = change / elapsed if elapsed > 0.0 else 0.0
        self.has_read = True
        self.seen = time
        links, dq, ddq, gravity = self.links, memory.dtheta, self.ddq, self.gravity
        place_links(self.chain, memory.positions, links)
        measure_accelerations(links, dq, ddq, gravity, self.top, self.top_readings)
        measure_accelerations(
            links, dq, ddq, gravity, self.bottom, self.bottom_readings
        )
        return self.readings

    def forget(self) -> None:
        """Begin anew, because the arm was set to another pose."""
        self.has_read = False


def _poses(boards: Iterable[tuple[Vector3, float]]) -> Doubles:
    return doubles(
        number
        for place, turn in boards
        for number in as_transform(Pose.from_rpy(place, (turn, 0.0, 0.0)))
    )
