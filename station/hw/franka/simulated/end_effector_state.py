"""The part of an arm's state that follows from its joint positions and frames."""

from collections.abc import Callable

from station.core.numerics.arm_chain import (
    new_links,
    place_links,
    twist_of,
    zero_jacobian,
)
from station.core.numerics.rigid_motion import compose
from station.memory.doubles import Doubles, zeros


class EndEffectorState:
    """Pose, twist and elbow of an arm, measured, desired and commanded.

    Args:
        fields: Returns the memory of a field of the arm's state, which has libfranka's
            names; the memory is kept.
        chain: The arm's chain of n joints, see `arm_chain`.
        extension: Position of joint 4 at which the arm is stretched out most [rad].
    """

    def __init__(
        self, fields: Callable[[str], Doubles], chain: Doubles, extension: float
    ) -> None:
        links = new_links(chain)
        joints = len(chain) // 4 - 1
        self.chain = chain
        self.links = links
        self.flange = links[16 * joints :]
        self.jacobian = zeros(6 * joints)
        self.extension = extension
        self.q = fields("q")
        self.q_d = fields("q_d")
        self.dq_d = fields("dq_d")
        self.ddq_d = fields("ddq_d")
        self.tool = fields("F_T_EE")
        self.pose = fields("O_T_EE")
        self.pose_d = fields("O_T_EE_d")
        self.pose_c = fields("O_T_EE_c")
        self.twist_d = fields("O_dP_EE_d")
        self.twist_c = fields("O_dP_EE_c")
        self.rate_c = fields("O_ddP_EE_c")
        self.elbow = fields("elbow")
        self.elbow_d = fields("elbow_d")
        self.elbow_c = fields("elbow_c")
        self.delbow_c = fields("delbow_c")
        self.ddelbow_c = fields("ddelbow_c")

    def refresh(self) -> None:
        """Bring the measured and the desired fields up to date."""
        place_links(self.chain, self.q, self.links)
        compose(self.flange, self.tool, self.pose)
        place_links(self.chain, self.q_d, self.links)
        compose(self.flange, self.tool, self.pose_d)
        zero_jacobian(self.links, self.pose_d, self.jacobian)
        twist_of(self.jacobian, self.dq_d, self.twist_d)
        bend(self.q, self.extension, self.elbow)
        bend(self.q_d, self.extension, self.elbow_d)

    def command_desired(self) -> None:
        """Let the commanded fields follow the desired ones, which are up to date."""
        for i in range(16):
            self.pose_c[i] = self.pose_d[i]
        for i in range(6):
            self.twist_c[i] = self.twist_d[i]
            self.rate_c[i] = 0.0
        self.elbow_c[0], self.elbow_c[1] = self.elbow_d[0], self.elbow_d[1]
        self.delbow_c[0], self.delbow_c[1] = self.dq_d[2], 0.0
        self.ddelbow_c[0], self.ddelbow_c[1] = self.ddq_d[2], 0.0

    def command_joint_motion(self) -> None:
        """Make the desired joint motion the commanded motion of the end effector."""
        self.refresh()
        self.command_desired()
        twist_of(self.jacobian, self.ddq_d, self.rate_c)


def bend(q: Doubles, extension: float, result: Doubles) -> None:
    """Write an elbow: position of joint 3 [rad], and sign of joint 4's flip.

    Args:
        q: Joint positions [rad], shape (n,).
        extension: Position of joint 4 at which the sign changes [rad].
        result: Receives the elbow, shape (2,).
    """
    flip = q[3] - extension
    result[0] = q[2]
    result[1] = 1.0 if flip > 0.0 else -1.0 if flip < 0.0 else 0.0
