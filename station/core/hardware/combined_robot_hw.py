"""Several robots as one, each seeing only the part of a switch that concerns it.

Source: ros_control@0.20.0 combined_robot_hw/src/combined_robot_hw.cpp; differs:
`switch_result` asks the robots instead of always answering DONE (CM-114), the robots
are asked for conflicts, too, and `init` raises with its reason.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

from typing_extensions import override

from station.core.description.urdf import Pose
from station.core.description.urdf_repair import Repair
from station.core.errors import HardwareInterfaceError, StationError
from station.core.hardware.async_robot_hw import AsyncRobotHW
from station.core.hardware.robot_hw import (
    ControllerInfo,
    HardwareComponent,
    InterfaceResources,
    ResourceConflict,
    RobotHW,
    SceneGuard,
    SimulatedWorld,
    SwitchState,
)
from station.core.hardware.robot_report import (
    ClampReport,
    ContactReport,
    JointLimitsReport,
    MovingBaseReport,
    SceneObjectReport,
)
from station.core.parameters import Parameters
from station.reports import HardwareTransmission


class CombinedWorld(SimulatedWorld):
    """Passes requests on to the worlds of simulated robots, in their order.

    Args:
        worlds: Each robot with its world; at least one.
    """

    def __init__(self, worlds: Sequence[tuple[RobotHW, SimulatedWorld]]) -> None:
        self._worlds = tuple(worlds)

    @override
    def time(self) -> float:
        """Return the time of the first robot's world [s]."""
        return self._worlds[0][1].time()

    @override
    def reset(self, positions: Mapping[str, float]) -> None:
        for robot, world in self._worlds:
            own = robot.resources()
            world.reset({n: p for n, p in positions.items() if n in own})

    @override
    def keyframes(self) -> Mapping[str, Mapping[str, float]]:
        """Return the keyframes of all worlds; keyframes of one name are merged."""
        found: dict[str, dict[str, float]] = {}
        for _, world in self._worlds:
            for name, positions in world.keyframes().items():
                found.setdefault(name, {}).update(positions)
        return found

    @override
    def place_object(self, name: str, pose: Pose) -> None:
        for _, world in self._worlds:
            if any(one.name == name for one in world.scene()):
                world.place_object(name, pose)

    @override
    def scene(self) -> Sequence[SceneObjectReport]:
        """Return the objects of all worlds; objects of one name are one object."""
        found = {
            thing.name: thing for _, world in self._worlds for thing in world.scene()
        }
        return list(found.values())

    @override
    def bases(self) -> Sequence[MovingBaseReport]:
        """Return the moving bases of all worlds."""
        return [base for _, world in self._worlds for base in world.bases()]

    @override
    def contacts(self) -> Sequence[ContactReport]:
        """Return the contacts of all worlds; worlds do not touch each other."""
        return [contact for _, world in self._worlds for contact in world.contacts()]

    @override
    def longest_period(self) -> float:
        """Return the longest of the worlds' longest periods [s]."""
        return max(world.longest_period() for _, world in self._worlds)


CreateRobot = Callable[[str], RobotHW]
"""Returns a new robot of a type, not yet initialised; raises a StationError."""


class CombinedRobotHW(RobotHW):
    """Reads, writes and switches its robots in the order of `robot_hardware`.

    Parameters: `robot_hardware`, a list of names; and per name a namespace with the
    robot's `type` and the parameters of that type.

    Args:
        create: Makes the robots.

    Attributes:
        robots: The robots by name, in order.
    """

    def __init__(self, create: CreateRobot) -> None:
        super().__init__()
        self._create = create
        self.robots: dict[str, RobotHW] = {}

    @override
    def init(self, root_params: Parameters, hw_params: Parameters) -> None:
        """Make and initialise all robots (CM-110).

        Args:
            root_params: Parameters of the station's root namespace.
            hw_params: Parameters of the combined robot.

        Raises:
            ParameterError: `robot_hardware` or a robot's `type` is missing.
            HardwareInterfaceError: A robot's `init` failed. Robots before it stay.
            StationError: There is no robot of that type.
        """
        for name in hw_params.get_str_list("robot_hardware"):
            params = hw_params.namespace(name)
            robot = AsyncRobotHW.wrap(self._create(params.get_str("type")), params)
            try:
                robot.init(root_params, params)
            # Its message names the cause and a remedy already.
            except StationError:
                raise
            except Exception as error:
                raise HardwareInterfaceError(
                    f"Robot '{name}' cannot be initialised: its init raised "
                    f"{type(error).__name__}: {error}.",
                    remedy="Correct its parameters or the robot.",
                    details={"robot": name},
                ) from error
            self.add_robot(name, robot)

    def add_robot(self, name: str, robot: RobotHW) -> None:
        """Add a robot that is initialised already.

        Args:
            name: Name of the robot.
            robot: The robot.
        """
        self.robots[name] = robot
        self.register_interface_manager(robot)

    @override
    def read(self, time: float, period: float) -> None:
        for robot in self.robots.values():
            robot.read(time, period)

    @override
    def write(self, time: float, period: float) -> None:
        for robot in self.robots.values():
            robot.write(time, period)

    @override
    def check_period(self, period: float) -> None:
        """Ask every robot whether it can be run with a loop.

        Args:
            period: Nominal period of the loop [s], > 0.

        Raises:
            HardwareInterfaceError: The loop is too fast or too slow for a robot.
        """
        for robot in self.robots.values():
            robot.check_period(period)

    @override
    def components(self) -> Sequence[HardwareComponent]:
        """Return the components of all robots, named after their robots."""
        found: list[HardwareComponent] = []
        for name, robot in self.robots.items():
            parts = robot.components()
            for part in parts:
                own = name if len(parts) == 1 else f"{name}_{part.name}"
                found.append(replace(part, name=own, key=part.key or part.name))
        return found

    @override
    def check_for_conflict(
        self, controllers: Sequence[ControllerInfo]
    ) -> list[ResourceConflict]:
        """Ask every robot about its part of the claims; robots have different rules.

        Args:
            controllers: All controllers that would be running after the switch.

        Returns:
            The conflicts of all robots, each once.
        """
        # Several robots may find the same conflict; a dict keeps each one once.
        conflicts: dict[ResourceConflict, None] = {}
        for robot in self.robots.values():
            for conflict in robot.check_for_conflict(_part_of(robot, controllers)):
                conflicts[conflict] = None
        return list(conflicts)

    @override
    def hold_commands(self) -> list[Sequence[str]]:
        """Return the command lines of all robots."""
        return [c for robot in self.robots.values() for c in robot.hold_commands()]

    @override
    def prepare_switch(
        self, start: Sequence[ControllerInfo], stop: Sequence[ControllerInfo]
    ) -> None:
        """Ask the robots in order, until a robot refuses (CM-111).

        Args:
            start: Controllers that will be started.
            stop: Controllers that will be stopped.

        Raises:
            SwitchRefusedError: A robot refuses.
        """
        for robot in self.robots.values():
            robot.prepare_switch(_part_of(robot, start), _part_of(robot, stop))

    @override
    def do_switch(
        self, start: Sequence[ControllerInfo], stop: Sequence[ControllerInfo]
    ) -> None:
        """Switch every robot, even after one of the robots has raised an error.

        Raises:
            Exception: The first error that a robot raised. By then all robots have
                switched, so that no robot is left in a mode whose controllers are
                stopped.
        """
        failure: Exception | None = None
        for robot in self.robots.values():
            try:
                robot.do_switch(_part_of(robot, start), _part_of(robot, stop))
            except Exception as error:  # noqa: BLE001 - raised again below
                # Switch the other robots, too: a robot that stays in its old mode would
                # get commands for the new one.
                failure = failure or error
        if failure is not None:
            raise failure

    @override
    def switch_result(self) -> SwitchState:
        return _together([robot.switch_result() for robot in self.robots.values()])

    @override
    def switch_result_for(self, controller: ControllerInfo) -> SwitchState:
        return _together([
            robot.switch_result_for(part)
            for robot in self.robots.values()
            for part in _part_of(robot, [controller])
        ])

    @override
    def joint_limits(self) -> Sequence[JointLimitsReport]:
        return [r for robot in self.robots.values() for r in robot.joint_limits()]

    @override
    def transmissions(self) -> Sequence[HardwareTransmission]:
        return [r for robot in self.robots.values() for r in robot.transmissions()]

    @override
    def repairs(self) -> Sequence[Repair]:
        return [r for robot in self.robots.values() for r in robot.repairs()]

    @override
    def clamps(self) -> Sequence[ClampReport]:
        return [r for robot in self.robots.values() for r in robot.clamps()]

    @override
    def is_interrupted(self) -> bool:
        return any(robot.is_interrupted() for robot in self.robots.values())

    @override
    def interruption_of(self, controller: ControllerInfo) -> str | None:
        reasons = [
            robot.interruption_of(part)
            for robot in self.robots.values()
            for part in _part_of(robot, [controller])
        ]
        return "; ".join(reason for reason in reasons if reason) or None

    @override
    def simulated_world(self) -> SimulatedWorld | None:
        """Return the worlds of all robots as one; None if a robot is real."""
        worlds = [(one, one.simulated_world()) for one in self.robots.values()]
        simulated = [(one, world) for one, world in worlds if world is not None]
        # A pause or a reset of the simulated robots would not stop the real ones.
        if not worlds or len(simulated) < len(worlds):
            return None
        return CombinedWorld(simulated)

    @override
    def guards(self) -> Sequence[SceneGuard]:
        return [one for robot in self.robots.values() for one in robot.guards()]

    @override
    def unguarded(self) -> Sequence[str]:
        return [name for name, robot in self.robots.items() if robot.unguarded()]

    @override
    def address(self) -> str:
        """Return the addresses of the real robots."""
        found = [robot.address() for robot in self.robots.values()]
        return ", ".join(address for address in found if address)

    @override
    def mode(self) -> str:
        """Return the first mode of a robot that is not `running`, or else `running`."""
        modes = [robot.mode() for robot in self.robots.values()]
        return next((mode for mode in modes if mode != "running"), "running")


def _together(states: list[SwitchState]) -> SwitchState:
    for state in (SwitchState.ERROR, SwitchState.ONGOING):
        if state in states:
            return state
    return SwitchState.DONE


def _part_of(
    robot: RobotHW, controllers: Sequence[ControllerInfo]
) -> list[ControllerInfo]:
    """Return the part of `controllers` that concerns `robot` (CM-112, CM-113).

    Resources that the robot does not have are left out, and so are controllers without
    any remaining resource. A controller without claims concerns every robot.
    """
    parts: list[ControllerInfo] = []
    for controller in controllers:
        claims: list[InterfaceResources] = []
        for claim in controller.claimed_resources:
            owned = set(robot.get_interface_resources(claim.hardware_interface))
            resources = tuple(r for r in claim.resources if r in owned)
            if resources:
                claims.append(InterfaceResources(claim.hardware_interface, resources))
        # A controller without claims concerns every robot, as upstream.
        if claims or not controller.claimed_resources:
            parts.append(
                ControllerInfo(controller.name, controller.type, tuple(claims))
            )
    return parts
