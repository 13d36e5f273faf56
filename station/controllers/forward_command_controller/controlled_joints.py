"""The values of a group of joints as doubles, for the kernel."""

from station.core.hardware.interfaces import JointGroup, JointStateGroup
from station.memory.doubles import Doubles, put, zeros


class ControlledJoints:
    """The measured values and the commands of a group of joints, shape (n,) each.

    Where the robot keeps the joints side by side in doubles, these are the robot's own
    values, and there is nothing to do. Otherwise they are copies.

    Args:
        group: The joints; without a `JointGroup` there is nothing to command.

    Attributes:
        size: The number of joints n.
        positions: Measured positions [rad or m].
        velocities: Measured velocities [rad/s or m/s].
        efforts: Measured efforts [Nm or N].
        commands: Commands in the unit of the interface.
        is_copy: Whether `read` has to be called before the values are used, and `write`
            after the commands were computed.
    """

    def __init__(self, group: JointStateGroup) -> None:
        self.size = len(group.names)
        self._group = group
        self._commanded = group if isinstance(group, JointGroup) else None
        measured = (group.positions, group.velocities, group.efforts)
        self.positions, self.velocities, self.efforts = (
            self._view_or_copy(view) for view in measured
        )
        commands = None if self._commanded is None else self._commanded.commands
        self.commands = self._view_or_copy(commands)
        writes = self._commanded is not None and commands is None
        self.is_copy = writes or any(view is None for view in measured)

    def _view_or_copy(self, view: Doubles | None) -> Doubles:
        return zeros(self.size) if view is None else view

    def read(self) -> None:
        """Copy what was measured, if these are copies."""
        group = self._group
        if group.positions is None:
            put(self.positions, group.get_positions())
        if group.velocities is None:
            put(self.velocities, group.get_velocities())
        if group.efforts is None:
            put(self.efforts, group.get_efforts())

    def write(self) -> None:
        """Command the joints, if these are copies."""
        group = self._commanded
        if group is not None and group.commands is None:
            group.set_commands([*self.commands])
