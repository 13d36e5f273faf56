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

from station.core.description.repair import Repair
from station.core.description.urdf import Pose
from station.core.errors import HardwareInterfaceError
from station.core.geometry.scene import SceneObject
from station.core.hardware.interfaces.interface_manager import InterfaceManager
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
    """Keeps an arm clear of a scene. Any thread, unless it says otherwise.

    Attributes:
        arm_id: Name of the arm.
    """

    arm_id: str

    @abstractmethod
    def hand(self) -> Pose:
        """Return the pose of the arm's flange in the world; control thread.

        Raises:
            SceneRefusedError: The robot carries nothing.
        """

    @abstractmethod
    def links(self) -> Sequence[str]:
        """Return the names of the links for which a role may count."""

    @abstractmethod
    def knows(self, link: str) -> bool:
        """Return whether a name in the `links` of an object is one of this robot."""

    @abstractmethod
    def carry(self, objects: Sequence[SceneObject]) -> Callable[[], None]:
        """Return a function for the control thread that makes objects parts of the arm.

        All arms take their carried objects before `prepare` lets the scene count.

        Args:
            objects: All objects of the scene; those that the arm carries count.

        Raises:
            RobotDescriptionError: A mesh cannot be used.
            SceneRefusedError: No robot can carry an object.
        """

    @abstractmethod
    def nearest_at(self, positions: Mapping[str, float]) -> Clearance | None:
        """Return the nearest pair in another pose; for copies of a station only.

        Args:
            positions: Joint name to position [rad]; others stay where they are.
        """

    @abstractmethod
    def prepare(
        self, objects: Sequence[SceneObject], arm_margin: float | None
    ) -> Callable[[], None]:
        """Return a function for the control thread that lets these objects count.

        Args:
            objects: All objects of the scene; those with the role `object` do not
                count.
            arm_margin: Distance that arms keep from each other [m]; None: none.

        Raises:
            RobotDescriptionError: A mesh cannot be used.
            ParameterError: The guard cannot keep this robot clear now.
        """

    @abstractmethod
    def report(self) -> Clearance | None:
        """Return the nearest pair and its distance; None where nothing counts."""


class SimulatedWorld(ABC):
    """The extras of a simulated robot: a time of its own, a scene, and a reset.

    `RobotHW.simulated_world` hands it out; a real robot has none. All methods belong to
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
        """Return the poses that have a name: joint name to position [rad or m]."""
        return {}

    def place_object(self, name: str, pose: Pose) -> None:
        """Put a solid object somewhere else, at rest.

        Args:
            name: Its name.
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
        """Return the poses of the robots' moving root links; without the fixed ones."""
        return ()

    def contacts(self) -> Sequence[ContactReport]:
        """Return the contacts between bodies; only some if there are very many."""
        return ()

    def distances(self) -> Callable[[], tuple[str, str, float] | None]:
        """Return a function that finds the bodies nearest to the links of a robot.

        It returns the names of a link and of a solid body that belongs to no robot, or
        to another one, and their distance [m]; None where there is none. Pairs that
        touch now do not count.
        """
        return lambda: None

    def nearness(
        self,
        joints: Sequence[str],
        margin: float,
        carried: Mapping[str, str] | None = None,
    ) -> Callable[[Sequence[float]], Sequence[tuple[str, str, float]]]:
        """Return a function that finds bodies that would be near each other in a pose.

        It takes positions of the joints [rad or m] and returns names of two bodies and
        their distance [m], negative inside of each other, for each pair below the
        margin. For copies of a station only: the world stays in that pose.

        Args:
            joints: Names of joints; the others stay where they are.
            margin: Distance below which bodies are near [m], > 0.
            carried: Link that carries a solid object, by the object's name; the object
                moves with the link from where it is now.

        Raises:
            HardwareInterfaceError: A joint is not in the world.
        """
        del joints, margin, carried
        return lambda _: ()

    def longest_period(self) -> float:
        """Return the most time that may pass in one cycle of the loop [s], > 0.

        A world may wait for a loop that is very late; station time then stands still,
        too. The default is infinity: the world never waits.
        """
        return inf


@dataclass(frozen=True, slots=True)
class InterfaceResources:
    """The resources a controller claims through one interface.

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
        references: References of other controllers that it claims, by their full names;
            not the robot's business.
    """

    name: str
    type: str
    claimed_resources: tuple[InterfaceResources, ...]
    references: tuple[str, ...] = ()


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
        resources: Names of its resources; None for all of the robot.
        key: Name by which the hooks of the robot know it; empty for `name`.
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

    A real arm has a clock, and a loop with another clock would see some of its states
    twice or never. So the loop waits for the arm.
    """

    def wait(self) -> int:
        """Wait for the robot's next state, some milliseconds at most.

        Returns:
            How many of its cycles have passed since the last call: usually 1, 0 if no
            state came. A robot that is lost lets time pass, so that the cycles go on.
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
    The commands of a `write` act from then on until the next `write`, so their effect
    shows in the `read` of the next cycle. A simulated robot therefore lets its world go
    on in `read`, under the commands of the cycle before: when a cycle is late, the old
    commands act for longer, as they do on a real robot. In a cycle whose period is zero
    no time passes.
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
        """Return the parts with a life cycle of their own; settled in `init`.

        The default is one component of the name `robot`.
        """
        kind = type(self)
        plugin = f"{kind.__module__}:{kind.__qualname__}"
        return (HardwareComponent("robot", self, plugin=plugin),)

    # The hooks of the life cycle, each for the component of a name. They are called
    # outside of the control thread and may block; the cycles go on meanwhile. To refuse
    # a change, and stay as before, a hook raises a StationError; any other exception is
    # an error, which `on_error` deals with.

    def on_configure(self, component: str) -> None:
        """Make the hardware readable: from unconfigured to inactive."""

    def on_cleanup(self, component: str) -> None:
        """Take back `on_configure`: from inactive to unconfigured."""

    def on_activate(self, component: str) -> None:
        """Let the hardware take commands: from inactive to active."""

    def on_deactivate(self, component: str) -> None:
        """Let the hardware refuse further commands: from active to inactive."""

    def on_shutdown(self, component: str) -> None:
        """Let the hardware go for good: from any state to finalized."""

    def on_error(self, component: str, problem: str) -> None:
        """Deal with an error of another hook: to unconfigured.

        Args:
            component: Name of the component.
            problem: The error, in words.

        Raises:
            Exception: The hardware cannot be used any more; it is finalized.
        """

    def check_for_conflict(
        self, controllers: Sequence[ControllerInfo]
    ) -> list[ResourceConflict]:
        """Return the conflicts among controllers that would run together.

        The default: every resource has at most one claim, whatever the interface
        (CM-52 … CM-57). Override it for a robot that allows more or less. Called by
        any thread, also in the control thread when a fallback is to take over: it
        must answer at once.

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
        """Refuse a loop that the robot cannot be run with; once, after `init`.

        Args:
            period: Nominal period of the loop [s], > 0.

        Raises:
            HardwareInterfaceError: The loop is too fast or too slow for the robot.
        """

    def hold_commands(self) -> Sequence[Sequence[str]]:
        """Return command lines that make the drivers of a real robot hold it.

        A process beside the station runs them, without a shell, when the control loop
        stands still; so each must work without the station, must be harmless when it is
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
            SwitchRefusedError: The hardware cannot do it; nothing has changed.
        """

    def do_switch(
        self, start: Sequence[ControllerInfo], stop: Sequence[ControllerInfo]
    ) -> None:
        """Begin the mode switch of the hardware, in the control thread.

        Must not fail. It is also called without `prepare_switch`: with an empty
        `start`, to take a failed controller off the hardware at once; for the
        fallback of such a controller; and to take a switch back whose start failed.
        """

    def switch_result(self) -> SwitchState:
        """Return the hardware's progress with the switch of all controllers."""
        return SwitchState.DONE

    def switch_result_for(self, controller: ControllerInfo) -> SwitchState:  # noqa: ARG002
        """Return the hardware's progress with the switch of `controller`."""
        return SwitchState.DONE

    def joint_limits(self) -> Sequence[JointLimitsReport]:
        """Return the limits it enforces; settled in `init`. Any thread."""
        return ()

    def transmissions(self) -> Sequence[HardwareTransmission]:
        """Return its transmissions; settled in `init`. Any thread."""
        return ()

    def repairs(self) -> Sequence[Repair]:
        """Return the changes that made a description usable; settled in `init`."""
        return ()

    def clamps(self) -> Sequence[ClampReport]:
        """Return the commands that limits have cut off. Any thread."""
        return ()

    def is_interrupted(self) -> bool:
        """Return whether the robot no longer carries out the commands of controllers.

        Called in the control thread once per cycle, after `read`: must be cheap. When
        it is true, the manager asks `interruption_of` for every running controller.
        """
        return False

    def interruption_of(self, controller: ControllerInfo) -> str | None:  # noqa: ARG002
        """Return the reason why a controller's commands are ignored; None if they act.

        The manager stops such a controller in the same cycle and calls `do_switch`.
        """
        return None

    def robot_clock(self) -> RobotClock | None:
        """Return the clock that paces the control thread; None for the wall clock.

        The same object from `init` on.
        """
        return None

    def close(self) -> None:
        """Let the hardware go, once nothing uses this robot any more."""

    def simulated_world(self) -> SimulatedWorld | None:
        """Return the simulated world of the robot; None for a real robot.

        The same object from `init` on.
        """
        return None

    def guards(self) -> Sequence[SceneGuard]:
        """Return the guards that keep this robot clear of a scene; may be empty.

        The same objects from `init` on.
        """
        return ()

    def unguarded(self) -> Sequence[str]:
        """Return the robots that no guard keeps clear; this one has the empty name."""
        return () if self.guards() else ("",)

    def address(self) -> str:
        """Return the address of a real robot, e.g. its IP; empty for a simulated one.

        People read it beside REAL ARM, so that they know which robot will move.
        """
        return ""

    def mode(self) -> str:
        """Return the robot's mode in one word, for status displays.

        Called in the control thread once per cycle: return a constant string.
        """
        return "running"


def _describe(resource: str, claims: list[tuple[str, str]]) -> str:
    holders = " and ".join(f"'{name}' ({interface})" for name, interface in claims)
    return f"Resource '{resource}' is claimed by {holders}."
