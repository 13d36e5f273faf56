"""Controllers: the life cycle, the two bases that people derive from, and the status.

Source: ros_control@0.20.0 controller_interface/controller_base.h, controller.h,
multi_interface_controller.h; differs: `init` raises with its reason instead of
returning False, and there is one `init(hw, params)` instead of overloads.
"""

from abc import ABC, abstractmethod
from array import array
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import Enum
from typing import ClassVar, Generic, NamedTuple, TypeAlias, TypeVar, get_args

from typing_extensions import get_original_bases, override

from station.core.control.sample_columns import PackedColumns, SampleColumns
from station.core.control.tunables import Tunables
from station.core.declared_parameter import DeclaredParameter, declare_number
from station.core.errors import ControllerLoadError
from station.core.hardware.interfaces.resource_manager import (
    HardwareResourceManager,
    interface_type_name,
)
from station.core.hardware.robot_hw import InterfaceResources, RobotHW
from station.core.parameters import Parameters
from station.core.ports.command_ticket import CommandTicket
from station.core.ports.goal import GoalPort  # noqa: TC001 - a native attribute
from station.core.ports.set_point import SetPointPort  # noqa: TC001 - a native attribute
from station.core.trajectory.quintic_spline_segment import PosVelAccState
from station.reports import AsyncStatistics, Percentiles

Columns: TypeAlias = tuple[list[float], list[float], list[float], list[float]]
"""The four lists of a sample, shape (n,) each."""
PUBLISH_RATE = declare_number(
    "publish_rate", "rate of publication; 0: nothing is published", unit="Hz"
)
"""The parameter of controllers that publish at a rate."""


class TrajectoryPort(ABC):
    """The topic `command` and the service `query_state` of a trajectory controller.

    All methods may be called from any thread.
    """

    @abstractmethod
    def follow_trajectory(
        self, request: Mapping[str, object], ticket: CommandTicket | None = None
    ) -> None:
        """Check a trajectory and let it replace the present one.

        Args:
            request: The message as JSON-compatible values.
            ticket: Notes the cycle that takes the trajectory.

        Raises:
            StationError: The trajectory cannot be followed; nothing changed.
        """

    @abstractmethod
    def hold(self, ticket: CommandTicket | None = None) -> None:
        """End the motion in the next cycle and hold the joints.

        Args:
            ticket: Notes the cycle that takes the request.
        """

    @abstractmethod
    def query_state(self, time: float) -> PosVelAccState:
        """Return the desired state of the joints at a time.

        Args:
            time: Station time [s].

        Raises:
            StationError: The controller knows no state at that time.
        """


class ControllerState(Enum):
    """The states of a controller's life cycle."""

    CONSTRUCTED = "unknown"
    INITIALIZED = "initialized"
    RUNNING = "running"
    STOPPED = "stopped"
    WAITING = "waiting"
    ABORTED = "aborted"
    LOADING = "loading"
    """Its code is being imported and initialised; not a state of ros_control."""


class ControllerSample:
    """Desired values, measurements and commands of one cycle, shape (n,) each.

    A sample never changes. Like a named tuple, it has `_fields` and `_asdict`.

    Args:
        stamp: Station time of the cycle [s].
        desired: Set-point, in the unit of the set-point.
        actual: Measured value, same unit.
        error: Difference of both, as the control law computes it.
        output: Commands written, in the unit of the hardware interface.

    Attributes:
        stamp: As given.
    """

    __slots__ = ("_columns", "stamp")

    _fields = ("stamp", "desired", "actual", "error", "output")

    def __init__(
        self,
        stamp: float,
        desired: list[float],
        actual: list[float],
        error: list[float],
        output: list[float],
    ) -> None:
        self.stamp = stamp
        self._columns: Columns = (desired, actual, error, output)

    @property
    def columns(self) -> Columns:
        """The lists `desired`, `actual`, `error` and `output`."""
        return self._columns

    @property
    def desired(self) -> list[float]:
        """Set-point, in the unit of the set-point."""
        return self.columns[0]

    @property
    def actual(self) -> list[float]:
        """Measured value, same unit."""
        return self.columns[1]

    @property
    def error(self) -> list[float]:
        """Difference of desired and actual, as the control law computes it."""
        return self.columns[2]

    @property
    def output(self) -> list[float]:
        """Commands written, in the unit of the hardware interface."""
        return self.columns[3]

    def memory(self) -> bytes:
        """Return the bytes of the four lists as doubles, one list after the other."""
        return b"".join(array("d", column).tobytes() for column in self.columns)

    def _asdict(self) -> dict[str, object]:
        return dict(zip(self._fields, (self.stamp, *self.columns), strict=True))

    @override
    def __repr__(self) -> str:
        fields = ", ".join(f"{name}={value}" for name, value in self._asdict().items())
        return f"{type(self).__name__}({fields})"


class JointStates(NamedTuple):
    """State of several joints in one cycle, the shape of `sensor_msgs/JointState`.

    All lists have the shape (n,).

    Attributes:
        stamp: Station time of the cycle [s].
        name: Names of the joints.
        position: Positions [rad or m].
        velocity: Velocities [rad/s or m/s].
        effort: Efforts [Nm or N].
    """

    stamp: float
    name: list[str]
    position: list[float]
    velocity: list[float]
    effort: list[float]


class PackedSample(ControllerSample):
    """A sample in one block of memory; its lists are made when they are read.

    Args:
        stamp: Station time of the cycle [s].
        packed: Doubles in the byte order of the machine: the four columns one after the
            other, then the columns that the controller adds.
        size: Length n of each column.

    Attributes:
        packed: As given.
        size: As given.
    """

    __slots__ = ("packed", "size")

    def __init__(self, stamp: float, packed: bytes, size: int) -> None:
        # Every cycle makes a sample, so as little as possible is done here.
        self.stamp = stamp
        self.packed = packed
        self.size = size

    @property
    @override
    def columns(self) -> Columns:
        return (self.column(0), self.column(1), self.column(2), self.column(3))

    @override
    def memory(self) -> bytes:
        return self.packed[: 32 * self.size]  # four columns of doubles

    def column(self, index: int) -> list[float]:
        """Return a column, shape (n,), also one that the controller added."""
        return self.tail(index)[: self.size]

    def tail(self, index: int) -> list[float]:
        """Return the numbers of a column and of all columns after it."""
        first = index * self.size
        return [*memoryview(self.packed).cast("d")[first:]]


def unpack_sample(sample: ControllerSample | PackedColumns) -> ControllerSample:
    """Return packed columns as a sample; a `ControllerSample` is returned unchanged."""
    return PackedSample(*sample) if isinstance(sample, tuple) else sample


class ControllerBase:
    """A controller as the manager sees it.

    Users override `starting`, `update`, `stopping`, `waiting` and `aborting`. All of
    these run in the control thread, must return quickly, and must not wait, log or do
    I/O. `init_request` runs outside of the control thread.

    Order of calls: the constructor and `init_request` once; then, any number of times,
    `starting`, `update` in every following cycle, and `stopping`. The state changes
    after a callback has returned. In all callbacks `time` is station time [s], and
    `period` is the time since the last cycle [s], >= 0.

    Attributes:
        state: State of the life cycle; only this class and the manager set it.
        set_points: Receives set-points; None when the controller takes none.
        goals: Receives goals; None when the controller takes none.
        trajectories: Receives trajectories without a goal; None when the controller
            takes none.
        tunables: The run-time parameters; empty unless `init` replaces the object.
        joint_names: Names of the elements of the lists in `sample`.
        sampled: Keeps the sample of each cycle; None for a controller that sets
            `sample` itself.
        accepted_parameters: Names of parameters that files written for the original
            controller have and that have no effect here. Any other parameter without
            effect is reported.
        own_parameters: The parameters that a class adds to those of its bases.
        messages: The latest messages by topic, which `published` returns.
    """

    accepted_parameters: ClassVar[tuple[str, ...]] = ()
    own_parameters: ClassVar[tuple[DeclaredParameter, ...]] = ()

    def __init__(self) -> None:
        self.state = ControllerState.CONSTRUCTED
        self.set_points: SetPointPort | None = None
        self.goals: GoalPort | None = None
        self.trajectories: TrajectoryPort | None = None
        self.tunables = Tunables()
        self.joint_names: list[str] = []
        self.sampled: SampleColumns | None = None
        self.messages: Mapping[str, Mapping[str, object]] = {}
        self._sample: ControllerSample | None = None

    @property
    def sample(self) -> ControllerSample | None:
        """The sample of the last cycle, a new object each time; None before the first.

        A controller sets it in every update, or has `sampled` pack its columns, which
        takes less time.
        """
        if self.sampled is None:
            return self._sample
        # Read once: the control thread may pack another sample meanwhile.
        newest = self.sampled.newest
        return None if newest is None else unpack_sample(newest)

    @sample.setter
    def sample(self, sample: ControllerSample) -> None:
        self._sample = sample

    @classmethod
    def declared_parameters(cls) -> tuple[DeclaredParameter, ...]:
        """Return the parameters that `init` reads, for people who load a controller.

        They are the `own_parameters` of all classes, those of the bases first. Read the
        parameters through these declarations, so that there is no second list of them.
        Override it with `(*super().declared_parameters(), …)` if a parameter depends
        on the class. Called without an instance, outside of the control thread.
        """
        classes = [vars(base) for base in reversed(cls.__mro__)]
        return tuple(one for each in classes for one in each.get("own_parameters", ()))

    def starting(self, time: float) -> None:
        """Prepare to run; command the robot to rest where it is."""

    def update(self, time: float, period: float) -> None:
        """Read the handles and command the robot, once per cycle.

        Args:
            time: Station time [s].
            period: Time since the last cycle [s], >= 0.
        """
        raise NotImplementedError

    def stopping(self, time: float) -> None:
        """Clean up before the robot takes the joints back."""

    def waiting(self, time: float) -> None:
        """React to a cycle in which the hardware is still switching."""

    def aborting(self, time: float) -> None:
        """React to a switch that the hardware could not complete."""

    def init_request(
        self, hw: RobotHW, params: Parameters
    ) -> tuple[InterfaceResources, ...]:
        """Initialise the controller and return the resources that it claims.

        Args:
            hw: The robot.
            params: The controller's namespace.

        Raises:
            ControllerLoadError: A required interface is missing, or the controller is
                not freshly constructed.
            StationError: Whatever the controller's `init` raises.
        """
        raise NotImplementedError

    def published(self) -> Mapping[str, Mapping[str, object]]:
        """Return the latest messages by topic; empty when there are none.

        Called in any thread. The values of a message are numbers, strings, lists of
        numbers, or mappings of these.
        """
        return self.messages

    def is_running(self) -> bool:
        """Return whether the controller is running."""
        return self.state is ControllerState.RUNNING

    def is_initialized(self) -> bool:
        """Return whether the controller is initialised and was never started."""
        return self.state is ControllerState.INITIALIZED

    def is_stopped(self) -> bool:
        """Return whether the controller was stopped."""
        return self.state is ControllerState.STOPPED

    def is_waiting(self) -> bool:
        """Return whether the controller waits for the hardware."""
        return self.state is ControllerState.WAITING

    def is_aborted(self) -> bool:
        """Return whether the hardware could not switch for this controller."""
        return self.state is ControllerState.ABORTED

    def update_request(self, time: float, period: float) -> None:
        """Call `update` when the controller is running."""
        if self.state is ControllerState.RUNNING:
            self.update(time, period)

    def start_request(self, time: float) -> bool:
        """Call `starting`; return False only before initialisation."""
        is_known = self.state is not ControllerState.CONSTRUCTED
        # A set-point that arrived before the start was meant for another situation.
        if is_known and self.set_points is not None:
            self.set_points.clear()
        return self._enter(ControllerState.RUNNING, self.starting, time)

    def stop_request(self, time: float) -> bool:
        """Call `stopping`; return False only before initialisation."""
        return self._enter(ControllerState.STOPPED, self.stopping, time)

    def wait_request(self, time: float) -> bool:
        """Call `waiting`; return False only before initialisation."""
        return self._enter(ControllerState.WAITING, self.waiting, time)

    def abort_request(self, time: float) -> bool:
        """Call `aborting`; return False only before initialisation."""
        return self._enter(ControllerState.ABORTED, self.aborting, time)

    def _enter(
        self, state: ControllerState, callback: Callable[[float], None], time: float
    ) -> bool:
        if self.state is ControllerState.CONSTRUCTED:
            return False
        callback(time)
        self.state = state
        return True


InterfaceT = TypeVar("InterfaceT")


class ClaimingController(ControllerBase):
    """A controller whose claims are the handles that its `init` asks for."""

    def interface_types(self) -> tuple[tuple[type, ...], tuple[type, ...]]:
        """Return the required and the optional interface types."""
        raise NotImplementedError

    def initialise(self, hw: RobotHW, params: Parameters) -> None:
        """Call the user's `init` with the arguments that it takes."""
        raise NotImplementedError

    @override
    def init_request(
        self, hw: RobotHW, params: Parameters
    ) -> tuple[InterfaceResources, ...]:
        if self.state is not ControllerState.CONSTRUCTED:
            raise ControllerLoadError(
                "Cannot initialise the controller: it is "
                f"{self.state.value}, not freshly constructed.",
                remedy="Load a new instance.",
            )
        interfaces = self._find_interfaces(hw)
        _clear_claims(interfaces)
        try:
            self.initialise(hw, params)
            claims = tuple(_claims_of(interface) for interface in interfaces)
        finally:
            _clear_claims(interfaces)
        self.state = ControllerState.INITIALIZED
        return claims

    def _find_interfaces(self, hw: RobotHW) -> list[object]:
        required, optional = self.interface_types()
        found: list[object] = []
        for interface_type in (*required, *optional):
            interface: object | None = hw.get(interface_type)
            # `_find_interfaces` has refused None already; this is for the type checker.
            if interface is not None:
                found.append(interface)
            elif interface_type in required:
                require_interface(hw, interface_type, type(self).__name__)
        return found


def require_interface(
    hw: RobotHW, interface_type: type[InterfaceT], whose: str = "the controller"
) -> InterfaceT:
    """Return the robot's interface of a type.

    Args:
        hw: The robot.
        interface_type: The type.
        whose: Name of the part that requires it, for the message.

    Raises:
        ControllerLoadError: The robot has no interface of that type.
    """
    interface = hw.get(interface_type)
    if interface is None:
        name = interface_type_name(interface_type)
        raise ControllerLoadError(
            f"The robot has no interface '{name}', which {whose} requires.",
            remedy=f"It offers: {', '.join(hw.get_names()) or 'none'}.",
            details={"hardware_interface": name},
        )
    return interface


def _clear_claims(interfaces: list[object]) -> None:
    for interface in interfaces:
        if isinstance(interface, HardwareResourceManager):
            interface.clear_claims()


def _claims_of(interface: object) -> InterfaceResources:
    claims: tuple[str, ...] = ()
    if isinstance(interface, HardwareResourceManager):
        claims = tuple(interface.get_claims())
    return InterfaceResources(interface_type_name(type(interface)), claims)


class Controller(ClaimingController, Generic[InterfaceT]):
    """A controller over one hardware interface.

    ```python
    class Brake(Controller[EffortJointInterface]):
        def init(self, interface, params):
            self.joint = interface.get_handle(params.get_str("joint"))

        def update(self, time, period):
            self.joint.set_command(-10.0 * self.joint.get_velocity())
    ```

    Attributes:
        hardware_interface: Type of the interface; taken from the type argument.
    """

    hardware_interface: ClassVar[type]

    @override
    def __init_subclass__(cls) -> None:
        """Take the interface from the type argument of the base class."""
        super().__init_subclass__()
        if "hardware_interface" in vars(cls):
            return
        for base in get_original_bases(cls):
            argument = next(iter(get_args(base)), None)
            # A type variable is bound later, by a class derived from this one.
            if isinstance(argument, type) and issubclass(base.__origin__, Controller):
                cls.hardware_interface = argument

    def init(self, interface: InterfaceT, params: Parameters) -> None:
        """Read parameters and ask `interface` for handles.

        Args:
            interface: The robot's interface of the declared type.
            params: The controller's namespace.

        Raises:
            StationError: The controller cannot be used with these parameters or this
                robot; the message states the reason.
        """

    @override
    def interface_types(self) -> tuple[tuple[type, ...], tuple[type, ...]]:
        return (self.hardware_interface,), ()

    @override
    def initialise(self, hw: RobotHW, params: Parameters) -> None:
        interface: InterfaceT | None = hw.get(self.hardware_interface)
        if interface is not None:
            self.init(interface, params)


class MultiInterfaceController(ClaimingController):
    """A controller over several hardware interfaces.

    Attributes:
        required_interfaces: Types of interfaces without which loading is refused.
        optional_interfaces: Types of interfaces that are used if the robot has them.
    """

    required_interfaces: ClassVar[tuple[type, ...]] = ()
    optional_interfaces: ClassVar[tuple[type, ...]] = ()

    def init(self, hw: RobotHW, params: Parameters) -> None:
        """Read parameters and ask `hw.get(InterfaceType)` for handles.

        Args:
            hw: The robot.
            params: The controller's namespace.

        Raises:
            StationError: The controller cannot be used with these parameters or this
                robot; the message states the reason.
        """

    @override
    def interface_types(self) -> tuple[tuple[type, ...], tuple[type, ...]]:
        return self.required_interfaces, self.optional_interfaces

    @override
    def initialise(self, hw: RobotHW, params: Parameters) -> None:
        self.init(hw, params)


@dataclass(frozen=True, slots=True)
class ControllerStatus:
    """A controller as `controller_manager_msgs/ControllerState` has it, and more.

    Attributes:
        name: Name under which it is loaded.
        type: Type as the parameters name it.
        state: State of its life cycle.
        claimed_resources: Claims, one entry per hardware interface (CM-85).
        fault: Why the manager stopped it; None if the manager did not.
        traceback: Traceback that belongs to `fault`; None if there is none.
        fallback: Names of the controllers that take over when it fails.
        time: Duration of its updates [s].
        notes: Warnings for its user, e.g. of a parameter that has no effect; one
            sentence or more each.
        update_rate: How often it is updated while it runs [Hz]; 0 while no loop is
            known.
        async_update: Report on its updates in a thread of its own; None if the control
            thread updates it.
    """

    name: str
    type: str
    state: ControllerState
    claimed_resources: tuple[InterfaceResources, ...]
    fault: str | None
    traceback: str | None
    fallback: tuple[str, ...]
    time: Percentiles
    notes: tuple[str, ...] = ()
    update_rate: float = 0.0
    async_update: AsyncStatistics | None = None


@dataclass(frozen=True, slots=True)
class ControllerCondition:
    """The part of a controller's status that changes; cheap to read often.

    Attributes:
        name: Name under which it is loaded.
        type: Type as the parameters name it.
        state: State of its life cycle.
        fault: Why the manager stopped it; None if the manager did not.
        traceback: Traceback that belongs to `fault`; None if there is none.
    """

    name: str
    type: str
    state: ControllerState
    fault: str | None
    traceback: str | None


@dataclass(frozen=True, slots=True)
class ControllerStatistics:
    """A controller as `controller_manager_msgs/ControllerStatistics` has it.

    Attributes:
        name: Name under which it is loaded.
        type: Its type.
        timestamp: Station time of the last cycle [s].
        running: Whether it runs.
        max_time: Longest update [s].
        mean_time: Mean duration of an update [s].
        variance_time: Variance of the durations [s^2].
        num_control_loop_overruns: Updates that took longer than the cycle's period.
        time_last_control_loop_overrun: Station time of the last such update [s].
        time: Percentiles of the durations [s]; its `count` is the number of updates.
        total_updates: Updates since it was loaded; a reset of the statistics does not
            change it.
        total_overruns: Overruns since it was loaded.
        update_rate: Rate of its updates while it runs [Hz].
    """

    name: str
    type: str
    timestamp: float
    running: bool
    max_time: float
    mean_time: float
    variance_time: float
    num_control_loop_overruns: int
    time_last_control_loop_overrun: float
    time: Percentiles
    total_updates: int
    total_overruns: int
    update_rate: float = 0.0
