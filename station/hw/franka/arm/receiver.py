"""A part of the seam: compiled code that takes the commands of an arm.

To pass a view of memory through a call of Python takes 0.2 us, 1 us when the caches are
cold. So the commands of a simulated arm are passed by a call of C.
"""

from station.memory.doubles import Storage


class Receiver:
    """Takes commands for the next cycle of an arm; the base class takes none.

    A command that is not taken has changed nothing and goes to the `command_...` method
    of `RobotArm`, which takes or refuses it. An arm of another package, e.g. behind a
    network, needs no receiver of its own.
    """

    def receive(self, values: Storage, kind: int) -> bool:
        """Return whether a command was taken.

        Args:
            values: Torques [Nm], positions [rad] or velocities [rad/s] of the joints,
                shape (7,), or a pose without an elbow, 16 numbers.
            kind: The motion that it belongs to, see `arm_codes`; `NO_MOTION` for
                torques.
        """
        return False

    def rests_at_pose(self) -> bool:
        """Return whether the end effector has come to rest at the last pose."""
        return False
