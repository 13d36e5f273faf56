"""The finger joints of a simulated hand, as controllers see them.

Source: franka_ros@c11f000 franka_gazebo/src/franka_hw_sim.cpp, FrankaHWSim.initSim,
writeSim; differs: the fingers also take position commands, unclaimed fingers hold their
position instead of going limp, and the joint states contain only the joints of the arm,
as with a real robot, whose hand is another device.
"""

from collections.abc import Iterable, Sequence
from math import isfinite

from station.core.franka import GripperServicesInterface
from station.core.hardware.interfaces import (
    EffortJointInterface,
    JointCommandInterface,
    JointHandle,
    JointStateHandle,
    JointStateInterface,
    PositionJointInterface,
)
from station.core.hardware.robot_hw import ControllerInfo, ResourceConflict
from station.hw.franka.hand.hand_limits import FASTEST
from station.hw.franka.hand.hand_services import HandMotor, HandServices
from station.memory.doubles import Block, put, zeros

_KINDS = (PositionJointInterface.type_name, EffortJointInterface.type_name)


class FingerJoints:
    """Offers handles of the two fingers; passes their commands on to the motor.

    The fingers are coupled: they have one position, and an effort acts on both. A
    controller that claims a finger claims the hand, through one kind of interface.

    While no controller claims the fingers, they follow the gripper's commands (`hand`).

    Args:
        gripper: The fingers' motor.
        names: Names of the two joints.
        arm_id: The arm with this hand.

    Attributes:
        names: As given.
        hand: Homing, move, grasp and stop.
        services: The interface that contains `hand`.
        sensor: Reads the state of the fingers.
        claimed: Claimed fingers, with the interface that each is commanded through.
    """

    def __init__(self, gripper: HandMotor, names: Sequence[str], arm_id: str) -> None:
        size = len(names)
        self.hand = HandServices(arm_id, gripper)
        self.services = GripperServicesInterface()
        self.services.register_handle(self.hand)
        self.names = tuple(names)
        self._gripper = gripper
        block = Block(
            dict.fromkeys(
                ("q", "dq", "tau", "position_command", "effort_command"), size
            )
        )
        self._positions = block["q"]
        self._position_commands = block["position_command"]
        self._effort_commands = block["effort_command"]
        self.sensor = gripper.sensor(self._positions, block["dq"], block["tau"])
        self.sensor.read()
        put(self._position_commands, self._positions)
        self.claimed: dict[str, str] = {}
        # Indices of the claimed fingers, and whether they are commanded by position:
        # `write` would have to find both in every cycle.
        self._claimed: list[int] = []
        self._is_position = False
        self._owners: dict[str, str] = {}
        self.states = [
            JointStateHandle(name, self._positions, block["dq"], block["tau"], index)
            for index, name in enumerate(names)
        ]

    def register(
        self,
        interfaces: Iterable[JointStateInterface | JointCommandInterface],
        *,
        in_states: bool = False,
    ) -> None:
        """Add the fingers to the interfaces for position and effort.

        Args:
            interfaces: The interfaces of the arm; other kinds do not change.
            in_states: Whether the joint states contain the fingers as franka_gripper
                publishes them: half of the width, without velocity and effort. Source:
                franka_ros@c11f000 franka_gripper_node.cpp.
        """
        none = zeros(len(self.names))
        for interface in interfaces:
            for index, state in enumerate(self.states):
                if in_states and type(interface) is JointStateInterface:
                    slots = (self.names[index], self._positions, none, none, index)
                    interface.register_handle(JointStateHandle(*slots))
                if isinstance(interface, PositionJointInterface):
                    handle = JointHandle(state, self._position_commands, index)
                    interface.register_handle(handle)
                elif isinstance(interface, EffortJointInterface):
                    handle = JointHandle(state, self._effort_commands, index)
                    interface.register_handle(handle)

    def write(self) -> None:
        """Pass on the commands of claimed fingers; without any, advance `hand`."""
        if not self.claimed:
            self.hand.advance()
            return
        is_position, claimed = self._is_position, self._claimed
        commands = self._position_commands if is_position else self._effort_commands
        total = 0.0
        for index in claimed:
            total += commands[index]
        if not isfinite(total):
            return
        if is_position:
            # The fingers move as one, so the position is the mean of their commands.
            lower, upper = self._gripper.limits
            self._hold(min(max(total / len(claimed), lower), upper))
        else:
            # An unclaimed finger adds no force.
            limit, force = self._gripper.effort_limit, total / len(self.names)
            self._gripper.press(min(max(force, -limit), limit), is_damped=False)

    def find_conflicts(
        self, controllers: Sequence[ControllerInfo]
    ) -> list[ResourceConflict]:
        """Return the reasons why some controllers cannot share the fingers.

        Args:
            controllers: All controllers that would be running.
        """
        holders = _holders(controllers, self.names)
        kinds = {kind for _, kind, _ in holders}
        if len(kinds) <= 1:
            return []
        parties = tuple(dict.fromkeys((owner, kind) for owner, kind, _ in holders))
        described = " and ".join(f"'{owner}' ({kind})" for owner, kind in parties)
        reason = (
            f"The fingers {' and '.join(self.names)} move as one; they cannot follow "
            f"{described} at once."
        )
        return [ResourceConflict(holders[0][2], parties, reason)]

    def do_switch(
        self, start: Sequence[ControllerInfo], stop: Sequence[ControllerInfo]
    ) -> None:
        """Follow started controllers from now on; released fingers hold their position.

        Args:
            start: Controllers that are started.
            stop: Controllers that are stopped.
        """
        stopped = _holders(stop, self.names)
        started = _holders(start, self.names)
        for _, _, name in stopped:
            self.claimed.pop(name, None)
            self._owners.pop(name, None)
        # A switch of other joints must not end the motion of the hand.
        if not stopped and not started:
            return
        size = len(self.names)
        self._hold(self._gripper.read_position())
        put(self._position_commands, [self._gripper.read_position()] * size)
        put(self._effort_commands, [0.0] * size)
        for owner, kind, name in started:
            self.claimed[name] = kind
            self._owners[name] = owner
        self._claimed = [self.names.index(name) for name in self.claimed]
        self._is_position = PositionJointInterface.type_name in self.claimed.values()
        self.hand.give_to(next(iter(self._owners.values()), None))

    def begin_anew(self) -> None:
        """Forget the commands, because the world was reset."""
        self.sensor.read()
        self.hand.begin_anew()
        put(self._position_commands, self._positions)
        put(self._effort_commands, [0.0] * len(self.names))

    def _hold(self, position: float) -> None:
        """Move both fingers to a position [m] at full speed, and hold it."""
        self._gripper.hold(2.0 * position, speed=FASTEST, force=None)


def _holders(
    controllers: Sequence[ControllerInfo], names: Sequence[str]
) -> list[tuple[str, str, str]]:
    """Return (controller, hardware interface, joint) of every claim of a finger."""
    return [
        (controller.name, claim.hardware_interface, resource)
        for controller in controllers
        for claim in controller.claimed_resources
        if claim.hardware_interface in _KINDS
        for resource in claim.resources
        if resource in names
    ]
