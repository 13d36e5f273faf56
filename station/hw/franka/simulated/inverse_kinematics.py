"""Inverse kinematics of an arm that keeps the position of one joint, a step at a time.

Six coordinates of the end effector do not determine the motion of seven joints. The
position of one joint, the elbow, is therefore given too, which makes the motion unique.
"""

from station.core.numerics.arm_chain import (
    WrenchEquation,
    new_links,
    place_links,
    torques_of,
    zero_jacobian,
)
from station.core.numerics.rigid_motion import compose, twist_between
from station.memory.doubles import Doubles, own
from station.memory.vectors import copy_into

# Damping of a step, relative to the matrix: for full accuracy, and for poses near a
# singularity, where an undamped step would be too large.
FINE_DAMPING = 1e-9
_COARSE_DAMPING = 1e-3
# A step of a joint [rad] that is larger, 50 rad/s at 1 kHz, shows a singularity.
_LARGEST_STEP = 0.05


class InverseKinematics:
    """Newton steps of the joints towards a pose; every array is kept and not copied.

    Args:
        chain: The chain of n joints, see `arm_chain`.
        q: Joint positions [rad], shape (n,).
        tool: End effector in the flange frame, 16 numbers.
        target: Pose to reach, 16 numbers.
        step: Receives a step [rad], shape (n,).
    """

    def __init__(
        self, chain: Doubles, q: Doubles, tool: Doubles, target: Doubles, step: Doubles
    ) -> None:
        size = len(q)
        self.chain = own(chain)
        self.q = q
        self.tool = tool
        self.target = target
        self.step = step
        self.links = own(new_links(chain))
        self.end = 16 * size
        self.flange, self.pose = own([0.0] * 16), own([0.0] * 16)
        self.jacobian = own([0.0] * (6 * size))
        self.error, self.wrench = own([0.0] * 6), own([0.0] * 6)
        self.equation = WrenchEquation()

    def advance(self, elbow: float) -> None:
        """Write the step that leads to the target, with joint 3 at a position [rad]."""
        step, jacobian, error = self.step, self.jacobian, self.error
        place_links(self.chain, self.q, self.links)
        copy_into(self.flange, 0, self.links[self.end :], 16)
        compose(self.flange, self.tool, self.pose)
        zero_jacobian(self.links, self.pose, jacobian)
        twist_between(self.pose, self.target, 1.0, error)
        bend = elbow - self.q[2]
        # Joint 3 has its position already: its column leaves the equation, and its
        # share of the way leaves the error.
        for k in range(12, 18):
            error[k - 12] -= bend * jacobian[k]
            jacobian[k] = 0.0
        self.solve(FINE_DAMPING)
        largest = _LARGEST_STEP
        lowest = -largest
        for joint in range(len(step)):
            if not lowest < step[joint] < largest:
                self.solve(_COARSE_DAMPING)
                break
        step[2] = bend

    def solve(self, damping: float) -> None:
        """Write the least motion of the joints that corrects the error."""
        if self.equation.factorise(self.jacobian, damping):
            self.equation.solve(self.error, self.wrench)
            torques_of(self.jacobian, self.wrench, self.step)
        else:
            for joint in range(len(self.step)):
                self.step[joint] = 0.0
