"""A part of the seam: compiled code that takes the commands of an arm.

To pass a view of memory through a call of Python takes 0.2 us, 1 us when the caches are
cold. So the commands of a simulated arm are passed by a call of C.
"""

from station.memory.doubles import Doubles, Storage


class Receiver:
    """Takes commands for the next cycle of an arm; the base class takes none.

    A command that is not taken has changed nothing and goes to the `command_...` method
    of `RobotArm`, which takes or refuses it. An arm of another package, e.g. behind a
    network, needs no receiver of its own.
    """

    def receive_torques(self, tau: Storage) -> bool:
        """Return whether torques [Nm], shape (7,), were taken."""
        return False

    def receive_positions(self, q: Storage) -> bool:
        """Return whether positions [rad], shape (7,), were taken."""
        return False

    def receive_velocities(self, dq: Storage) -> bool:
        """Return whether velocities [rad/s], shape (7,), were taken."""
        return False

    def receive_pose(self, pose: Doubles) -> bool:
        """Take a pose, 16 numbers, without an elbow; return whether it was taken."""
        return False

    def rests_at_pose(self) -> bool:
        """Return whether the end effector has come to rest at the last pose."""
        return False
