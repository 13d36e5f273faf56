"""The states of joints that no motor moves."""

from collections.abc import Sequence

from station.core.hardware.interfaces import JointStateHandle, JointStateInterface
from station.hw.mujoco.world import World
from station.hw.mujoco.world_joints import WorldJointStates


class UnpoweredJoints:
    """Puts the states of some joints into the joint states.

    Args:
        world: The simulated world.
        names: Joints of the world with one degree of freedom.
        interface: Gets their handles, whose effort is 0.
    """

    def __init__(
        self, world: World, names: Sequence[str], interface: JointStateInterface
    ) -> None:
        self._joints = WorldJointStates(world.model, world.data, names)
        self._position, self._velocity = [0.0] * len(names), [0.0] * len(names)
        effort = [0.0] * len(names)
        for index, name in enumerate(names):
            interface.register_handle(
                JointStateHandle(name, self._position, self._velocity, effort, index)
            )

    def read(self) -> None:
        """Bring the states up to date. Control thread."""
        self._position[:] = self._joints.read_positions()
        self._velocity[:] = self._joints.read_velocities()
