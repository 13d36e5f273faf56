"""Pose and Jacobian of a frame that a chain of any joints carries.

Poses have 16 numbers, flat and column-major. A Jacobian has 6 n numbers, column-major,
rows vx vy vz wx wy wz, in the axes of the base.
"""

from station.core.numerics.arm_chain import turn_to_outer_axes
from station.core.numerics.rigid_motion import compose, displace
from station.memory.doubles import Doubles, Storage, doubles, zeros


class JointChain:
    """The joints between a base and a frame.

    Args:
        size: Number n of the positions that are given; the chain may have fewer joints.
        origins: Pose of each joint of the chain in the frame that carries it, and at
            last of the frame in that of the last joint, 16 numbers each.
        axes: Axis of each joint of the chain in its own frame, 3 numbers each.
        turns: 1 for each joint that turns, 0 for each that slides.
        indices: Index among the n positions of each joint of the chain.

    Attributes:
        pose: Pose of the frame in the base, 16 numbers.
        jacobian: Its Jacobian, 6 n numbers; 0 for a joint that is not in the chain.
    """

    def __init__(
        self,
        size: int,
        origins: Storage,
        axes: Storage,
        turns: Storage,
        indices: Storage,
    ) -> None:
        self.count = len(turns)
        self.origins = doubles(origins)
        self.axes = doubles(axes)
        self.turns = doubles(turns)
        self.indices = doubles(indices)
        self.pose = zeros(16)
        self.jacobian = zeros(6 * size)
        self.way = zeros(6)
        # Axis and origin of each joint in the base frame.
        self.screws = zeros(6 * len(turns))

    def place(self, q: Doubles) -> None:
        """Bring the pose up to date.

        Args:
            q: Joint positions [rad or m], shape (n,).
        """
        pose, way, axes, screws = self.pose, self.way, self.axes, self.screws
        for k in range(16):
            pose[k] = self.origins[k]
        for joint in range(self.count):
            angle = q[int(self.indices[joint])]
            turn_to_outer_axes(pose, axes[3 * joint : 3 * joint + 3], way)
            k = 6 * joint
            screws[k], screws[k + 1], screws[k + 2] = way[0], way[1], way[2]
            screws[k + 3], screws[k + 4], screws[k + 5] = pose[12], pose[13], pose[14]
            if self.turns[joint] != 0.0:
                way[3], way[4], way[5] = way[0], way[1], way[2]
                way[0] = way[1] = way[2] = 0.0
            else:
                way[3] = way[4] = way[5] = 0.0
            displace(pose, way, angle, pose)
            compose(pose, self.origins[16 * joint + 16 : 16 * joint + 32], pose)

    def differentiate(self) -> None:
        """Bring the Jacobian up to date with the pose."""
        px, py, pz = self.pose[12], self.pose[13], self.pose[14]
        screws, jacobian = self.screws, self.jacobian
        for joint in range(self.count):
            k, column = 6 * joint, 6 * int(self.indices[joint])
            ax, ay, az = screws[k], screws[k + 1], screws[k + 2]
            x, y, z = px - screws[k + 3], py - screws[k + 4], pz - screws[k + 5]
            if self.turns[joint] != 0.0:
                jacobian[column] = ay * z - az * y
                jacobian[column + 1] = az * x - ax * z
                jacobian[column + 2] = ax * y - ay * x
                jacobian[column + 3] = ax
                jacobian[column + 4] = ay
                jacobian[column + 5] = az
            else:
                jacobian[column], jacobian[column + 1] = ax, ay
                jacobian[column + 2] = az
