"""The robot as the controller manager sees it: read, write, and switching hooks.

Source: ros_control@0.20.0 hardware_interface/robot_hw.h, controller_info.h,
interface_resources.h; differs: a conflict is described instead of reported as `True`,
and a refused switch raises with its reason instead of returning `False`.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from math import inf
from typing import Protocol

from station.core.description.urdf import Pose
from station.core.description.urdf_repair import Repair
from station.core.errors import HardwareInterfaceError
from station.core.geometry.scene import SceneObject
from station.core.hardware.interfaces.resource_manager import InterfaceManager
from station.core.hardware.robot_report import (
    ClampReport,
    ContactReport,
    JointLimitsReport,
    MovingBaseReport,
    SceneObjectReport,
)
from station.core.parameters import Parameters
from station.reports import Clearance, HardwareTransmission


class SceneGuard(ABC):
    """Keeps an arm clear of a scene. For any thread, unless a method says otherwise.

    Attributes:
        arm_id: Name of the arm.
    """

    arm_id: str

    @abstractmethod
    def hand(self) -> Pose:
        """Return the pose of the arm's flange in the world; control thread.

        Raises:
            SceneRefusedError: This robot can carry no objects.
        """

    @abstractmethod
    def links(self) -> Sequence[str]:
        """Return the names of the links to which a role of an object may apply."""

    @abstractmethod
    def knows(self, link: str) -> bool:
        """Return whether a name in the `links` of an object is a link of this robot."""

    @abstractmethod
    def carry(self, objects: Sequence[SceneObject]) -> Callable[[], None]:
        """Return a function, for the control thread, that adds objects to the arm.

        The functions of all arms are called before those of `prepare`.

        Args:
            objects: All objects of the scene; the arm takes those that it carries.

        Raises:
            RobotDescriptionError: A mesh cannot be used.
            SceneRefusedError: An object cannot be carried.
        """

    @abstractmethod
    def nearest_at(self, positions: Mapping[str, float]) -> Clearance | None:
        """Return the nearest pair in another pose; only in a copy of a station.

        Args:
            positions: Joint name to position [rad]; other joints stay as they are.
        """

    @abstractmethod
    def prepare(
        self, objects: Sequence[SceneObject], arm_margin: float | None
    ) -> Callable[[], None]:
        """Return a function, for the control thread, that puts a scene into force.

        Args:
            objects: All objects of the scene; objects with the role `object` are
                ignored.
            arm_margin: Distance that arms keep from each other [m]; None for no
                distance.

        Raises:
            RobotDescriptionError: A mesh cannot be used.
            ParameterError: The guard cannot keep this robot clear now.
        """

    @abstractmethod
    def report(self) -> Clearance | None:
        """Return the nearest pair and its distance; None if there is no pair."""


class SimulatedWorld(ABC):
    """The extras of a simulated robot: a time of its own, a scene, and a reset.

    `RobotHW.simulated_world` returns it; a real robot has none. All methods belong to
    the control thread, between two cycles or within one.
    """

    @abstractmethod
    def time(self) -> float:
        """Return the simulated time since the last reset [s]."""

    @abstractmethod
    def reset(self, positions: Mapping[str, float]) -> None:
        """Put the world back to its start: time and velocities become zero.

        The loop voids all commands and restarts the running controllers afterwards.

        Args:
            positions: Joint name to position [rad or m]; joints that are not named go
                back to where they began.

        Raises:
            HardwareInterfaceError: A joint is not in the world; nothing changed.
        """

    def keyframes(self) -> Mapping[str, Mapping[str, float]]:
        """Return the named poses: joint name to position [rad or m]."""
        return {}

    def place_object(self, name: str, pose: Pose) -> None:
        """Move a solid object to another pose, at rest.

        Args:
            name: Name of the object.
            pose: Pose of its middle in the world.

        Raises:
            HardwareInterfaceError: The world has no such object.
        """
        raise HardwareInterfaceError(
            f"This world cannot move '{name}' to {pose.xyz}.",
            remedy="Change scene.objects of the configuration.",
        )

    def scene(self) -> Sequence[SceneObjectReport]:
        """Return the objects around the robot, at their present poses."""
        return ()

    def bases(self) -> Sequence[MovingBaseReport]:
        """Return the poses of root links of robots that are not fixed to the world."""
        return ()

    def contacts(self) -> Sequence[ContactReport]:
        """Return the contacts between bodies; only some if there are very many."""
        return ()

    def distances(self) -> Callable[[], tuple[str, str, float] | None]:
        """Return a function that finds the body nearest to the links of a robot.

        The function returns the name of a link, the name of a solid body that belongs
        to no robot or to another one, and their distance [m]; None if there is no such
        pair. Pairs that touch when this method is called are ignored.
        """
        return lambda: None

    def nearness(
        self,
        joints: Sequence[str],
        margin: float,
        carried: Mapping[str, str] | None = None,
    ) -> Callable[[Sequence[float]], Sequence[tuple[str, str, float]]]:
        """Return a function that finds the bodies that are near each other in a pose.

        The function takes positions of the joints [rad or m]. For each pair of bodies
        below the margin it returns both names and the distance [m], negative if they
        overlap. For copies of a station only, because the world stays in that pose.

        Args:
            joints: Names of joints; other joints stay as they are.
            margin: Distance below which bodies are near [m], > 0.
            carried: Name of a solid object to the link that carries it; the object
                moves with the link from its present pose.

        Raises:
            HardwareInterfaceError: A joint is not in the world.
        """
        del joints, margin, carried
        return lambda _: ()

    def longest_period(self) -> float:
        """Return the longest time that may pass in one cycle of the loop [s], > 0.

        A world may wait for a loop that is very late; station time then stands still,
        too. By default it is infinite: the world never waits.
        """
        return inf


@dataclass(frozen=True, slots=True)
class InterfaceResources:
    """The resources that a controller claims through one interface.

    Attributes:
        hardware_interface: Wire name, e.g. `hardware_interface::EffortJointInterface`.
        resources: Claimed names, sorted; empty for an interface that claims nothing.
    """

    hardware_interface: str
    resources: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ControllerInfo:
    """A controller as the hardware sees it.

    Attributes:
        name: Name under which it is loaded.
        type: Its type, `package/Class`.
        claimed_resources: One entry per hardware interface it uses.
        references: Full names of the references of other controllers that it claims;
            the robot ignores them.
        states: Full names of the exported states of other controllers that it reads.
    """

    name: str
    type: str
    claimed_resources: tuple[InterfaceResources, ...]
    references: tuple[str, ...] = ()
    states: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class ResourceConflict:
    """The reason why a set of controllers cannot run together.

    Attributes:
        resource: The resource in dispute.
        holders: (controller, hardware interface) of every claim on the resource.
        reason: One sentence for the user.
    """

    resource: str
    holders: tuple[tuple[str, str], ...]
    reason: str


@dataclass(frozen=True, slots=True)
class HardwareComponent:
    """A part of a robot that has a life cycle of its own.

    Attributes:
        name: Its name, unique among the components of a station.
        robot: The robot whose hooks are called.
        type: `system`, `actuator` or `sensor`.
        plugin: Class of its robot, `package/Class` or `module:Class`.
        resources: Names of its resources; None for all resources of the robot.
        key: Name of the component in the robot's own hooks; empty if it is `name`.
    """

    name: str
    robot: "RobotHW"
    type: str = "system"
    plugin: str = ""
    resources: frozenset[str] | None = None
    key: str = ""


class SwitchState(Enum):
    """The hardware's progress with a switch."""

    DONE = "done"
    ONGOING = "ongoing"
    ERROR = "error"


class RobotClock(Protocol):
    """Paces a control thread in the place of the wall clock. Control thread only.

    A real arm has its own clock. A loop with another clock would see some of the arm's
    states twice or not at all, so the loop waits for the arm.
    """

    def wait(self) -> int:
        """Wait for the robot's next state, some milliseconds at most.

        Returns:
            Number of the robot's cycles since the last call: usually 1, or 0 if no
            state came. While the robot is lost time passes, so that cycles continue.
        """


class RobotHW(InterfaceManager):
    """Base of all robots.

    A robot keeps its state and commands in lists of floats, registers interfaces
    whose handles point into them, and moves values between these lists and the
    hardware. Threads: `init`, `check_for_conflict` and `prepare_switch` are called
    outside of the control thread and may block; `read`, `write`, `do_switch`,
    `switch_result…` run in the control thread and must not wait, log or allocate
    growing data.

    Order in a cycle: `read`, the update of the controllers, `do_switch` and
    `switch_result` when a switch is pending, `write`.

    Time: the state that `read` brings belongs to the station time of the same cycle.
    The commands of a `write` act until the next `write`, so their effect shows in the
    `read` of the next cycle. A simulated robot therefore advances its world in `read`,
    under the commands of the cycle before: when a cycle is late, the old commands act
    for longer, as they do on a real robot. In a cycle whose period is zero no time
    passes.
    """

    def init(self, root_params: Parameters, hw_params: Parameters) -> None:
        """Set the robot up. Called once before the first cycle.

        Args:
            root_params: Parameters of the station's root namespace.
            hw_params: Parameters of this robot.

        Raises:
            StationError: The robot cannot be used; subclasses say why.
        """

    def read(self, time: float, period: float) -> None:
        """Bring the hardware's state into the handles' storage.

        A simulated robot lets `period` pass in its world first.

        Args:
            time: Station time of this cycle [s], to which the state belongs.
            period: Time since the last cycle [s], >= 0.
        """

    def write(self, time: float, period: float) -> None:
        """Send the commands in the handles' storage to the hardware.

        The commands act from now until the next call.

        Args:
            time: Station time of this cycle [s].
            period: Time since the last cycle [s], >= 0.
        """

    def components(self) -> Sequence[HardwareComponent]:
        """Return the parts with a life cycle of their own; fixed after `init`.

        By default there is one component, of the name `robot`.
        """
        kind = type(self)
        plugin = f"{kind.__module__}:{kind.__qualname__}"
        return (HardwareComponent("robot", self, plugin=plugin),)

    # The hooks of the life cycle. The manager calls them for a component by name,
    # outside of the control thread; they may block, and the cycles continue meanwhile.
    # A hook refuses a change by a StationError, and the component stays as before. Any
    # other exception is an error, which `on_error` handles.

    def on_configure(self, component: str) -> None:
        """Make the hardware readable: from unconfigured to inactive."""

    def on_cleanup(self, component: str) -> None:
        """Undo `on_configure`: from inactive to unconfigured."""

    def on_activate(self, component: str) -> None:
        """Let the hardware accept commands: from inactive to active."""

    def on_deactivate(self, component: str) -> None:
        """Let the hardware refuse further commands: from active to inactive."""

    def on_shutdown(self, component: str) -> None:
        """Release the hardware for good: from any state to finalized."""

    def on_error(self, component: str, problem: str) -> None:
        """Handle an error of another hook; the component becomes unconfigured.

        Args:
            component: Name of the component.
            problem: The error, in words.

        Raises:
            Exception: The hardware cannot be used any more; it becomes finalized.
        """

    def check_for_conflict(
        self, controllers: Sequence[ControllerInfo]
    ) -> list[ResourceConflict]:
        """Return the conflicts among controllers that would run together.

        By default every resource has at most one claim, whatever the interface (CM-52 …
        CM-57). Override it for a robot that allows more or less. Called in any thread,
        also in the control thread before a fallback takes over: it must answer at once.

        Args:
            controllers: All controllers that would be running after the switch.

        Returns:
            One entry per conflict; an empty list when they can run together.
        """
        holders: dict[str, list[tuple[str, str]]] = {}
        for controller in controllers:
            for claimed in controller.claimed_resources:
                for resource in claimed.resources:
                    holders.setdefault(resource, []).append((
                        controller.name,
                        claimed.hardware_interface,
                    ))
        return [
            ResourceConflict(resource, tuple(claims), _describe(resource, claims))
            for resource, claims in holders.items()
            if len(claims) > 1
        ]

    def check_period(self, period: float) -> None:
        """Refuse a loop that does not suit the robot; called once, after `init`.

        Args:
            period: Nominal period of the loop [s], > 0.

        Raises:
            HardwareInterfaceError: The loop is too fast or too slow for the robot.
        """

    def hold_commands(self) -> Sequence[Sequence[str]]:
        """Return command lines that make the drivers of a real robot hold it.

        A process beside the station runs them, without a shell, when the control loop
        stands still. So each must work without the station, must be harmless if it is
        repeated, and must end within 1 s. A simulated robot needs none: its world
        stands still with the loop.
        """
        return ()

    def prepare_switch(
        self, start: Sequence[ControllerInfo], stop: Sequence[ControllerInfo]
    ) -> None:
        """Check, outside of the control thread, whether a switch is possible.

        Args:
            start: Controllers that are not running and will be started.
            stop: Controllers that are running and will be stopped.

        Raises:
            SwitchRefusedError: The hardware cannot do the switch; nothing has changed.
        """

    def do_switch(
        self, start: Sequence[ControllerInfo], stop: Sequence[ControllerInfo]
    ) -> None:
        """Begin the mode switch of the hardware, in the control thread.

        Must not fail. It is also called without `prepare_switch`: with an empty
        `start`, to take a failed controller off the hardware at once; to start its
        fallback; and to take back a switch in which a start failed.
        """

    def switch_result(self) -> SwitchState:
        """Return the hardware's progress with the switch of all controllers."""
        return SwitchState.DONE

    def switch_result_for(self, controller: ControllerInfo) -> SwitchState:  # noqa: ARG002
        """Return the hardware's progress with the switch of `controller`."""
        return SwitchState.DONE

    def joint_limits(self) -> Sequence[JointLimitsReport]:
        """Return the limits that the robot enforces; fixed after `init`. Any thread."""
        return ()

    def transmissions(self) -> Sequence[HardwareTransmission]:
        """Return the robot's transmissions; fixed after `init`. Any thread."""
        return ()

    def repairs(self) -> Sequence[Repair]:
        """Return the changes that made the description usable; fixed after `init`."""
        return ()

    def clamps(self) -> Sequence[ClampReport]:
        """Return the commands that limits have changed, and how often. Any thread."""
        return ()

    def is_interrupted(self) -> bool:
        """Return whether the robot no longer carries out the commands of controllers.

        Called in the control thread once per cycle, after `read`: must be cheap. When
        it is true, the manager asks `interruption_of` for every running controller. The
        manager looks the method up once, when it is made, because that takes time.
        """
        return False

    def interruption_of(self, controller: ControllerInfo) -> str | None:  # noqa: ARG002
        """Return the reason why a controller's commands are ignored; None if they act.

        The manager stops such a controller in the same cycle and calls `do_switch`.
        """
        return None

    def robot_clock(self) -> RobotClock | None:
        """Return the clock that paces the control thread; None for the wall clock.

        It is the same object from `init` on.
        """
        return None

    def close(self) -> None:
        """Release the hardware, once nothing uses this robot any more."""

    def simulated_world(self) -> SimulatedWorld | None:
        """Return the simulated world of the robot; None for a real robot.

        It is the same object from `init` on.
        """
        return None

    def guards(self) -> Sequence[SceneGuard]:
        """Return the guards that keep this robot clear of a scene; may be empty.

        They are the same objects from `init` on.
        """
        return ()

    def unguarded(self) -> Sequence[str]:
        """Return the names of robots without a guard; this robot has the empty name."""
        return () if self.guards() else ("",)

    def address(self) -> str:
        """Return the address of a real robot, e.g. its IP; empty for a simulated one.

        People read it next to REAL ARM, so that they know which robot will move.
        """
        return ""

    def mode(self) -> str:
        """Return the robot's mode in one word, for status displays.

        Called in the control thread once per cycle: return a constant string. The loop
        looks the method up once, when it is made, because that takes time.
        """
        return "running"


def _describe(resource: str, claims: list[tuple[str, str]]) -> str:
    holders = " and ".join(f"'{name}' ({interface})" for name, interface in claims)
    return f"Resource '{resource}' is claimed by {holders}."
