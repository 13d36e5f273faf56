"""A part of the seam: compiled code that takes the commands of an arm.

Passing a view of memory through a Python call takes 0.2 us, or 1 us if the caches are
cold. So the commands of a simulated arm are passed by a call in C.
"""

from station.memory.doubles import Storage


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
            kind: Kind of the motion, see `arm_codes`; `NO_MOTION` for torques.
        """
        return False

    def rests_at_pose(self) -> bool:
        """Return whether the end effector has come to rest at the last pose."""
        return False
