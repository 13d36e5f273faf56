"""Choose the command that each joint of a simulated robot follows, some by a PID."""

from collections.abc import Mapping, Sequence
from math import isfinite

from station.core.description.urdf import Joint, JointType
from station.core.errors import ParameterError
from station.core.hardware.interfaces import (
    EffortJointInterface,
    JointCommandInterface,
    PositionJointInterface,
    VelocityJointInterface,
)
from station.core.hardware.robot_hw import ControllerInfo
from station.core.hardware.transmissions import RawJointData
from station.core.numerics.joint_errors import (
    shortest_angular_distance,
    shortest_angular_distance_with_limits,
)
from station.core.numerics.pid import Pid
from station.core.parameters import Parameters
from station.hw.mujoco.joint_drives import DriveMode
from station.memory.doubles import Storage

COMMAND_INTERFACES: Mapping[str, type[JointCommandInterface]] = {
    "position": PositionJointInterface,
    "velocity": VelocityJointInterface,
    "effort": EffortJointInterface,
}
"""The interface through which controllers command each quantity."""
_QUANTITY_OF_INTERFACE = {
    interface.type_name: quantity for quantity, interface in COMMAND_INTERFACES.items()
}
# Speed below which a joint without commands is held at its position [rad/s or m/s].
_REST_VELOCITY = 0.01


class SimulatedPid:
    """Turns a position or velocity command of one joint into an effort.

    Args:
        joint: The joint.
        pid: The PID controller of the joint.

    Source: gazebo_ros_control@2.9.2 default_robot_hw_sim.cpp,
    DefaultRobotHWSim::writeSim.
    """

    def __init__(self, joint: Joint, pid: Pid) -> None:
        self._type = joint.type
        self._limit = joint.limit
        self._pid = pid

    def reset(self) -> None:
        """Reset the PID controller: its last error and its integral are 0 again."""
        self._pid.reset()

    def effort_for_position(
        self, command: float, position: float, period: float
    ) -> float:
        """Return the effort [Nm or N] for a position command [rad or m].

        Args:
            command: Desired position [rad or m].
            position: Measured position [rad or m].
            period: Time since the last cycle [s], > 0.
        """
        return self._saturate(
            self._pid.compute_command(self._error(command, position), period)
        )

    def effort_for_velocity(
        self, command: float, velocity: float, period: float
    ) -> float:
        """Return the effort [Nm or N] for a velocity command [rad/s or m/s].

        Args:
            command: Desired velocity [rad/s or m/s].
            velocity: Measured velocity [rad/s or m/s].
            period: Time since the last cycle [s], > 0.
        """
        return self._saturate(self._pid.compute_command(command - velocity, period))

    def _error(self, command: float, position: float) -> float:
        limit = self._limit
        if self._type is JointType.CONTINUOUS:
            return shortest_angular_distance(position, command)
        if self._type is not JointType.REVOLUTE or limit is None:
            return command - position
        if limit.lower is None or limit.upper is None:
            return command - position
        return shortest_angular_distance_with_limits(
            position, command, limit.lower, limit.upper
        )

    def _saturate(self, effort: float) -> float:
        if self._limit is None:
            return effort
        return max(-self._limit.effort, min(self._limit.effort, effort))


def read_simulated_pids(
    params: Parameters, joints: Mapping[str, Joint]
) -> dict[str, SimulatedPid]:
    """Return the controllers of the joints that have gains.

    Args:
        params: The namespace that has `pid_gains/<joint>`.
        joints: The joints that may have gains, by name.

    Raises:
        ParameterError: Gains are malformed, or belong to an unknown joint.
    """
    gains = params.namespace("pid_gains")
    pids = {}
    for name in gains.keys():  # noqa: SIM118 - no mapping
        if name not in joints:
            raise ParameterError(
                f"Parameter '{gains.resolve(name)}' names no joint with a motor.",
                remedy=f"Choose among {', '.join(joints) or 'none'}.",
                details={"parameter": gains.resolve(name)},
            )
        pids[name] = SimulatedPid(
            joints[name], Pid.from_parameters(gains.namespace(name))
        )
    return pids


class JointCommandModes:
    """The modes of the joints, and the commands of joints that no controller commands.

    A joint follows the commands of the interface through which a controller claims it.
    For a joint with gains, a position or velocity command becomes an effort here. A
    joint without gains has a servo as its drive. An unclaimed joint brakes and then
    holds the position at which it has come to rest.

    Args:
        joints: State and commands of the n joints.
        pids: Controllers of the joints that have gains, by name.
        modes: The drives' modes, shape (n,); changed in place.

    Attributes:
        commanded: Quantity of each joint that a controller commands; None for an
            unclaimed joint.
        in_use: (joint, quantity) of each command that controllers give.
        quantities: Quantities that the drives need.
    """

    def __init__(
        self,
        joints: RawJointData,
        pids: dict[str, SimulatedPid],
        modes: Storage,
    ) -> None:
        count = len(joints.names)
        self._joints = joints
        self._pids = [pids.get(name) for name in joints.names]
        self._drives = modes
        self.commanded: list[str | None] = [None] * count
        self._is_held = [False] * count
        self._held_position = [0.0] * count
        self.in_use: list[tuple[str, str]] = []
        self.quantities: list[str] = []
        self._update()

    def switch(
        self, start: Sequence[ControllerInfo], stop: Sequence[ControllerInfo]
    ) -> None:
        """Change the modes; a new mode begins with a command that holds the joint."""
        before = list(self.commanded)
        for info in stop:
            self._set(info, commanded=False)
        for info in start:
            self._set(info, commanded=True)
        for index, quantity in enumerate(self.commanded):
            if quantity != before[index]:
                self._begin(index)
        self._update()

    def efforts_of(self, start: Sequence[ControllerInfo]) -> list[str]:
        """Return the joints that these controllers would command by efforts."""
        return [
            name
            for info in start
            for claim in info.claimed_resources
            if _QUANTITY_OF_INTERFACE.get(claim.hardware_interface) == "effort"
            for name in claim.resources
            if name in self._joints.names
        ]

    def restart(self) -> None:
        """Begin all modes anew; called after a reset of the world."""
        for index in range(len(self.commanded)):
            self._begin(index)

    def release_bad_commands(self) -> bool:
        """Take joints whose command is not finite from their controllers.

        Such joints are held until the next switch. Call it before limits are enforced:
        a limit may turn a NaN into a finite number, and the joint would move.

        Returns:
            Whether a joint was released.
        """
        total = 0.0
        for index, quantity in enumerate(self.commanded):
            if quantity:
                total += self._joints.commands(quantity)[index]
        if isfinite(total):
            return False
        for index, quantity in enumerate(self.commanded):
            if quantity and not isfinite(self._joints.commands(quantity)[index]):
                self.commanded[index] = None
                self._begin(index)
        self._update()
        return True

    def command_joints(self, period: float) -> None:
        """Hold the joints that no controller commands, and run the PID controllers.

        Args:
            period: Time since the last cycle [s], > 0.
        """
        joints = self._joints
        for index, quantity in enumerate(self.commanded):
            if not quantity:
                self._hold(index)
                continue
            pid = self._pids[index]
            if pid is None:
                continue
            if quantity == "position":
                joints.effort_command[index] = pid.effort_for_position(
                    joints.position_command[index], joints.position[index], period
                )
            elif quantity == "velocity":
                joints.effort_command[index] = pid.effort_for_velocity(
                    joints.velocity_command[index], joints.velocity[index], period
                )

    def _hold(self, index: int) -> None:
        joints = self._joints
        if not self._is_held[index]:
            self._held_position[index] = joints.position[index]
            self._is_held[index] = abs(joints.velocity[index]) < _REST_VELOCITY
        joints.position_command[index] = self._held_position[index]

    def _set(self, info: ControllerInfo, *, commanded: bool) -> None:
        for claim in info.claimed_resources:
            quantity = _QUANTITY_OF_INTERFACE.get(claim.hardware_interface)
            if quantity is None:
                continue
            for name in claim.resources:
                if name in self._joints.names:
                    index = self._joints.names.index(name)
                    self.commanded[index] = quantity if commanded else None

    def _begin(self, index: int) -> None:
        joints = self._joints
        joints.position_command[index] = joints.position[index]
        joints.velocity_command[index] = 0.0
        joints.effort_command[index] = 0.0
        self._is_held[index] = False
        pid = self._pids[index]
        if pid is not None:
            pid.reset()

    def _update(self) -> None:
        self.in_use = []
        quantities = set()
        for index, quantity in enumerate(self.commanded):
            if quantity:
                self.in_use.append((self._joints.names[index], quantity))
            has_pid = bool(quantity) and self._pids[index] is not None
            driven_by = "effort" if has_pid else quantity or "position"
            self._drives[index] = DriveMode[driven_by.upper()]
            quantities.add(driven_by)
        self.quantities = sorted(quantities)
