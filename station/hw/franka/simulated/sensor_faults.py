"""Faults of one simulated arm, which occur on request for a number of cycles."""

from station.core.errors import InvalidCommandError
from station.core.franka.franka_robot_state import RobotState
from station.core.franka.franka_services import FaultKind, SimulatedFault
from station.hw.mujoco.world import Push, World
from station.hw.mujoco.world_joints import WorldJoints

LONGEST_DELAY = 500
"""Largest number of nominal periods by which a cycle of the loop can be delayed."""
# Damping of a stuck joint [Nm s/rad].
# The 87 Nm of the strongest joint turn it by less than 1e-4 rad/s.
_STUCK_DAMPING = 1e6
_NAN = float("nan")


class SensorFaults:
    """Injects faults into the simulation. Control thread only.

    Args:
        world: The world.
        joints: The arm's joints in the world.
        hand: Name of the body that a collision hits.
    """

    def __init__(self, world: World, joints: WorldJoints, hand: str) -> None:
        self._world = world
        self._joints = joints
        self._hand = hand
        self._lost = 0
        self._drops = False
        self._stuck: dict[int, int] = {}
        self._blind: dict[int, int] = {}

    @property
    def act(self) -> bool:
        """Return whether a fault acts on commands, readings or joints."""
        return bool(self._lost or self._stuck or self._blind or self._drops)

    def inject(self, fault: SimulatedFault) -> None:
        """Begin a fault; an active fault of the same kind ends.

        A delayed cycle is carried out by the control loop; only its length is checked.

        Raises:
            InvalidCommandError: A cycle would be delayed for too long.
            HardwareInterfaceError: The world lacks the body that a collision hits.
        """
        index = fault.joint - 1
        match fault.kind:
            case FaultKind.LOST_PACKETS:
                self._lost = fault.cycles
            case FaultKind.NAN_SENSOR:
                self._blind[index] = fault.cycles
            case FaultKind.STUCK_JOINT:
                self._stuck[index] = fault.cycles
                self._joints.set_extra_damping(index, _STUCK_DAMPING)
            case FaultKind.COLLISION:
                self._world.push(Push(self._hand, fault.force), fault.cycles)
            case FaultKind.DELAYED_CYCLE:
                _check_delay(fault.cycles)

    def clear(self) -> None:
        """End every fault and every push."""
        self._lost = 0
        self._drops = False
        self._blind.clear()
        self._world.end_pushes()
        for index in list(self._stuck):
            self._free(index)

    def active(self) -> list[SimulatedFault]:
        """Return the active faults and pushes with their remaining cycles."""
        found = [
            SimulatedFault(FaultKind.COLLISION, max(1, push.left))
            for push in self._world.pushes.values()
        ]
        if self._lost:
            found.append(SimulatedFault(FaultKind.LOST_PACKETS, self._lost))
        for kind, joints in (
            (FaultKind.NAN_SENSOR, self._blind),
            (FaultKind.STUCK_JOINT, self._stuck),
        ):
            # A joint with 0 cycles left stays stuck until the next step frees it.
            found += [
                SimulatedFault(kind, max(1, left), index + 1)
                for index, left in joints.items()
            ]
        return found

    def count_step(self) -> None:
        """Count down the cycles of stuck joints."""
        for index, left in list(self._stuck.items()):
            if left > 0:
                self._stuck[index] = left - 1
            else:
                self._free(index)

    def loses_packet(self) -> bool:
        """Return whether this cycle's command is lost; count the cycle."""
        if not self._lost:
            return self._drops
        self._lost -= 1
        return True

    def drop(self) -> None:
        """Lose the next command, as a network sometimes does; this is not a fault."""
        self._drops = True

    def finish_cycle(self) -> None:
        """Forget a dropped command: its cycle is over."""
        self._drops = False

    def disturb(self, state: RobotState) -> None:
        """Replace the readings of blind sensors in the state by NaN."""
        for index, left in list(self._blind.items()):
            state.doubles("q")[index] = _NAN
            if left > 1:
                self._blind[index] = left - 1
            else:
                del self._blind[index]

    def _free(self, index: int) -> None:
        del self._stuck[index]
        self._joints.set_extra_damping(index, 0.0)


def _check_delay(cycles: int) -> None:
    if cycles > LONGEST_DELAY:
        raise InvalidCommandError(
            f"'cycles' of a delayed cycle is {cycles}; allowed are at most "
            f"{LONGEST_DELAY}.",
            remedy="Give fewer cycles: the station does not answer meanwhile.",
            details={"cycles": cycles},
        )
