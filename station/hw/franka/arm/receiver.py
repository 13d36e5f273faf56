"""The part of the seam for compiled code: numbers of modes, and the taker of commands.

The numbers are those of libfranka's RobotMode, and of kinds of commands. Passing a view
of memory through a Python call takes 0.2 us, or 1 us if the caches are cold. So the
commands of a simulated arm are passed by a call in C.
"""

from station.memory.doubles import Storage

IDLE = 1
"""Mode of an arm that holds its pose."""
MOVE = 2
"""Mode of an arm that follows a motion."""
GUIDING = 3
"""Mode of an arm that a person guides."""
RECOVERY = 6
"""Mode of an arm that recovers from an error."""

NO_MOTION = 0
"""Generator of an arm whose motion commands only torques, or nothing."""
POSITIONS = 1
"""Generator of joint positions."""
VELOCITIES = 2
"""Generator of joint velocities."""
CARTESIAN = 3
"""Generator of poses or twists of the end effector."""


class Receiver:
    """Takes commands for the next cycle of an arm; the base class takes none.

    A command that is not taken has changed nothing, and goes to the `command_…` method
    of `RobotArm`, which takes or refuses it. An arm of another package, e.g. behind a
    network, does not need its own receiver.
    """

    def receive(self, values: Storage, kind: int) -> bool:
        """Take a command if possible; return whether it was taken.

        Args:
            values: Torques [Nm], positions [rad] or velocities [rad/s] of the joints,
                shape (7,), or a pose without an elbow, 16 numbers.
            kind: Kind of the motion, e.g. `POSITIONS`; `NO_MOTION` for torques.
        """
        return False

    def rests_at_pose(self) -> bool:
        """Return whether the end effector has come to rest at the last pose."""
        return False
