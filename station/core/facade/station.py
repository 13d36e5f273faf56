"""The facade: everything that code outside the control thread may ask and do.

Every method is safe to call from any thread, may block for a moment, and either
succeeds as a whole or raises an error of `station.core.errors` and changes nothing.
"""

import threading
import uuid
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, fields, replace

from station.compiled import CompilationStatus, present_status
from station.core.control.controller import (
    ControllerSample,
    ControllerState,
    ControllerStatus,
)
from station.core.control.controller_factory import LOAD_TIMEOUT
from station.core.control.controller_manager import ControllerManager
from station.core.control.hardware_components import ComponentState
from station.core.control.switching import Strictness, SwitchRequest, SwitchResult
from station.core.description.urdf_repair import Repair
from station.core.errors import (
    ControllerExistsError,
    LoopError,
    ParameterError,
    suggest,
)
from station.core.facade.gain_tuning import GainTuning
from station.core.facade.input_log import InputLog
from station.core.facade.motion_commands import MotionCommands
from station.core.facade.parameter_server import ParameterServer
from station.core.facade.robots import Robots
from station.core.facade.scene import StationScene
from station.core.facade.simulation_control import SimulationControl
from station.core.hardware.robot_hw import RobotHW
from station.core.hardware.robot_report import (
    ClampReport,
    ContactReport,
    JointLimitsReport,
    MovingBaseReport,
    SceneObjectReport,
)
from station.core.loop.control_loop import ControlLoop
from station.core.loop.snapshot import Snapshot, SnapshotRing
from station.core.loop.stop_latch import StopState
from station.core.parameters import Parameters
from station.reports import (
    HardwareComponentReport,
    HardwareInterface,
    HardwareResource,
    HardwareTransmission,
    LoopReport,
    LoopState,
    LoopStatistics,
    Simulation,
)


@dataclass(frozen=True, slots=True)
class StationStatus:
    """A summary of the station.

    Attributes:
        boot_id: Random name of this run of the process.
        epoch: Commands from an older epoch are void.
        time: Station time [s].
        cycle: Number of the last cycle.
        robot_type: Type of the robot, `package/Class`.
        robot_label: SIMULATION, or REAL ARM with its address.
        robot_mode: The robot's mode in one word.
        stop_state: State of the latched stop.
        stop_reason: Why it was engaged last.
        loop: State and statistics of the loop.
        kernel: Whether the arithmetic of the cycle runs interpreted or compiled.
        simulation: State of the simulation; None for a real robot.
        clamps: Commands that limits have changed.
        command_violations: Number of commands that were written without a claim.
        last_command_violation: The last such write, in words; None without one.
    """

    boot_id: str
    epoch: int
    time: float
    cycle: int
    robot_type: str
    robot_label: str
    robot_mode: str
    stop_state: StopState
    stop_reason: str
    loop: LoopReport
    kernel: CompilationStatus
    simulation: Simulation | None
    clamps: tuple[ClampReport, ...]
    command_violations: int
    last_command_violation: str | None


def label_robot(hw: RobotHW) -> str:
    """Return the label that tells people whether a real robot moves.

    Args:
        hw: The robot; a combined one is real if any of its robots is.
    """
    if hw.simulated_world() is not None:
        return "SIMULATION"
    address = hw.address()
    return f"REAL ARM {address}" if address else "REAL ROBOT"


@dataclass(frozen=True, slots=True)
class HardwareReport:
    """The facts about the robot that rarely change.

    Attributes:
        interfaces: Interfaces that controllers can ask for.
        limits: The joints' limits.
        transmissions: Transmissions between actuators and joints.
        clamps: Commands that limits have changed.
        repairs: Differences of the robot from its description.
    """

    interfaces: tuple[HardwareInterface, ...]
    limits: tuple[JointLimitsReport, ...]
    transmissions: tuple[HardwareTransmission, ...]
    clamps: tuple[ClampReport, ...]
    repairs: tuple[Repair, ...]


def report_hardware(
    robot: RobotHW, controllers: Sequence[ControllerStatus]
) -> HardwareReport:
    """Return the report on a robot. Any thread.

    Args:
        robot: The robot; its interfaces do not change after `init`.
        controllers: The loaded controllers.
    """
    claims: dict[tuple[str, str], list[str]] = {}
    for status in controllers:
        if status.state is not ControllerState.RUNNING:
            continue
        for claimed in status.claimed_resources:
            for resource in claimed.resources:
                key = (claimed.hardware_interface, resource)
                claims.setdefault(key, []).append(status.name)
    interfaces = [
        HardwareInterface(
            name,
            tuple(
                HardwareResource(resource, tuple(claims.get((name, resource), ())))
                for resource in robot.get_interface_resources(name)
            ),
        )
        for name in robot.get_names()
    ]
    return HardwareReport(
        tuple(interfaces),
        tuple(robot.joint_limits()),
        tuple(robot.transmissions()),
        tuple(robot.clamps()),
        tuple(robot.repairs()),
    )


FRESH = 0.25
"""Age of the last cycle beyond which the loop counts as hanging [s]."""


class Station:
    """One robot, its controllers and its loop, for any number of threads.

    Args:
        loop: The loop; started and stopped by its owner.
        manager: The loop's controller manager.
        parameters: The root of the parameter tree; each controller has a namespace.
        robot_type: Type of the robot for the status.
        reserved: Names at the root of the tree that no controller may have.
        fixed: Reserved names whose values cannot be changed while the station runs.

    Attributes:
        loop: The loop.
        manager: Its controller manager.
        boot_id: Random name of this run.
        inputs: Inputs of the station since its first cycle, for re-runs.
        motion: Commands of motion: set-points, trajectories and goals.
        robots: The robots, their services and recovery.
        tuning: Gains of controllers: changed in one cycle, and taken back.
        parameter_server: The tree of parameters, read and changed.
        simulation: Pause, step and reset of a simulated robot.
        surroundings: The objects around the robots, and their roles.
        watchdog_failure: Why no watchdog looks after the station now; None if one does,
            or if none is wanted.
    """

    def __init__(
        self,
        loop: ControlLoop,
        manager: ControllerManager,
        parameters: Parameters,
        robot_type: str = "",
        reserved: frozenset[str] = frozenset(),
        fixed: frozenset[str] = frozenset(),
    ) -> None:
        self.loop = loop
        self.manager = manager
        self.inputs = InputLog(loop)
        self.motion = MotionCommands(loop, manager, self.inputs)
        self.robots = Robots(loop, manager, self.inputs)
        self.simulation = SimulationControl(loop, self.inputs)
        self.surroundings = StationScene(loop, parameters, self.robots, self.inputs)
        self.boot_id = uuid.uuid4().hex
        self.watchdog_failure: str | None = None
        self.parameters = parameters
        self._robot_type = robot_type
        self._reserved = reserved
        self._change_lock = threading.Lock()
        self.tuning = GainTuning(loop, manager, self._change_lock, self.inputs)
        self.parameter_server = ParameterServer(
            parameters, self._change_lock, manager.is_loading, fixed
        )

    @property
    def epoch(self) -> int:
        """The present epoch; commands of an older epoch are void."""
        return self.loop.epoch

    @property
    def snapshots(self) -> SnapshotRing:
        """The ring with one snapshot per cycle."""
        return self.loop.snapshots

    @property
    def joint_names(self) -> list[str]:
        """Names of the joints in the snapshots, in their order."""
        return self.loop.joint_names

    def latest(self) -> Snapshot:
        """Return the newest snapshot.

        Raises:
            LoopError: No cycle has run yet.
        """
        snapshot = self.snapshots.latest()
        if snapshot is None:
            raise LoopError("No cycle has run yet.", remedy="Start the control loop.")
        return snapshot

    def status(self) -> StationStatus:
        """Return a summary of the station."""
        snapshot = self.snapshots.latest()
        latch = self.loop.stop_latch
        violations, last_violation = self.manager.command_violations
        return StationStatus(
            boot_id=self.boot_id,
            epoch=self.loop.epoch,
            time=snapshot.stamp if snapshot else self.loop.time,
            cycle=snapshot.cycle if snapshot else self.loop.cycle,
            robot_type=self._robot_type,
            robot_label=label_robot(self.loop.hw),
            robot_mode=snapshot.mode if snapshot else "unknown",
            stop_state=latch.state,
            stop_reason=latch.reason,
            loop=self.loop.report(),
            kernel=present_status(),
            simulation=self.simulation.find(),
            clamps=tuple(self.loop.hw.clamps()),
            command_violations=violations,
            last_command_violation=last_violation,
        )

    def hardware(self) -> HardwareReport:
        """Return the robot's interfaces, claims, limits, transmissions and clamps."""
        return report_hardware(self.loop.hw, self.manager.list_controllers())

    def bases(self) -> list[MovingBaseReport]:
        """Return the poses of the root links of simulated robots with a moving base.

        Raises:
            LoopError: The loop died or hangs.
        """
        world = self.loop.hw.simulated_world()
        return [] if world is None else list(self.loop.run_in_cycle(world.bases))

    def scene(self) -> list[SceneObjectReport]:
        """Return the objects around the robots, solid ones at their present poses.

        Raises:
            LoopError: The loop died or hangs.
        """
        return self.surroundings.report()

    def contacts(self) -> list[ContactReport]:
        """Return the contacts between bodies of a simulated world.

        Raises:
            LoopError: The loop died or hangs.
        """
        world = self.loop.hw.simulated_world()
        return [] if world is None else list(self.loop.run_in_cycle(world.contacts))

    def dead(self) -> str | None:
        """Return the reason why only a restart helps; None while the loop is alive."""
        if self.loop.state is not LoopState.FAILED:
            return None
        return f"The control loop died: {self.loop.failure_summary()}"

    def ready(self) -> str | None:
        """Return the reason why the station is not ready; None if it is ready."""
        dead = self.dead()
        if dead is not None:
            return dead
        if self.loop.state is not LoopState.RUNNING:
            return "The control loop is not running."
        age = self.loop.age()
        if age > FRESH:
            return f"The last cycle is {age:.2f} s old; the loop hangs."
        return self.watchdog_failure

    def loop_statistics(self) -> LoopStatistics:
        """Return the loop's report with the times of each controller. Any thread."""
        report = self.loop.report()
        values = {each.name: getattr(report, each.name) for each in fields(report)}
        times = {status.name: status.time for status in self.controllers()}
        return LoopStatistics(**values, controllers=times)

    def reset_statistics(self) -> None:
        """Start the statistics of the loop and of all controllers anew.

        Raises:
            LoopError: The loop died or hangs.
        """

        def reset() -> None:
            self.loop.begin_statistics()
            self.manager.reset_statistics()

        self.loop.run_in_cycle(reset)

    def controllers(self) -> list[ControllerStatus]:
        """Return all loaded controllers in the order of loading."""
        return self.manager.list_controllers()

    def controller(self, name: str) -> ControllerStatus:
        """Return one controller that is loaded or being loaded.

        Raises:
            ControllerNotFoundError: There is no controller of that name.
        """
        for status in self.manager.list_controllers():
            if status.name == name:
                return status
        self.manager.get_controller(name)  # raises, and names those that are loaded
        return self.controller(name)  # it was loaded in between

    def load_controller(
        self,
        name: str,
        controller_type: str | None = None,
        params: Mapping[str, object] | None = None,
        *,
        timeout: float = LOAD_TIMEOUT,
        strict: bool = False,
    ) -> ControllerStatus:
        """Load a controller; a second identical call changes nothing.

        No other caller waits: meanwhile the controller is listed as loading, and
        `unload_controller` cancels the loading.

        Args:
            name: Name to load it under.
            controller_type: `package/Class` or `module:Class`; None takes the type in
                the parameters under `name`.
            params: The parameters; None takes those in the parameter tree.
            timeout: How long import, constructor and `init` may take [s wall time].
            strict: Whether to refuse a parameter that the type does not know.
                Otherwise the notes of the controller list it, as with parameters that
                were written for ROS.

        Raises:
            ControllerExistsError: Something else is loaded under that name, or a
                controller of that name is being loaded.
            ControllerTypeNotFoundError: There is no such type.
            ControllerLoadError: The controller cannot be initialised, or not in time,
                or its loading was cancelled; it is not loaded.
            ParameterError: A parameter is missing or impossible.
        """
        with ExitStack() as stack:
            with self._change_lock:
                before = self.parameters.get(name)
                wanted = self._wanted_parameters(name, controller_type, params, before)
                is_known = any(s.name == name for s in self.manager.list_controllers())
                if is_known and not self.manager.is_loading(name):
                    if wanted == before:
                        return self.controller(name)
                    raise ControllerExistsError(
                        f"Controller '{name}' is loaded already, with other "
                        "parameters.",
                        remedy="Unload it first, or choose another name.",
                        details={"controller": name},
                    )
                announced = self.manager.announce(name, strict=strict)
                loading = stack.enter_context(announced)
                self.parameters.set(name, wanted)
            try:
                # Without the lock: the controller's code may take long, or hang.
                self.manager.finish_loading(loading, timeout)
            except BaseException:
                with self._change_lock:
                    self._restore(name, before)
                raise
            with self._change_lock:
                self.tuning.begin_revision(name)
        self.inputs.note("load", name=name, params=wanted)
        return self.controller(name)

    def unload_controller(self, name: str) -> None:
        """Unload a controller that is not running, or cancel its loading.

        Raises:
            ControllerNotFoundError: There is no controller of that name.
            ControllerStateError: The controller is running.
        """
        with self._change_lock:
            self.manager.unload_controller(name)
        self.inputs.note("unload", name=name)

    def switch_controllers(self, request: SwitchRequest) -> SwitchResult:
        """Start and stop controllers, all in one cycle.

        Raises:
            StoppedError: The station is stopped and a controller is to be started.
            SwitchRefusedError: The switch is not possible; nothing changed.
            SwitchTimeoutError: The hardware did not finish the switch in time.
            LoopError: The loop died.
        """
        self.loop.check_alive()
        if request.start and not request.dry_run:
            self.loop.stop_latch.check()
        if request.dry_run:
            return self.manager.switch_controller(request)
        ticket = request.ticket or self.motion.ticket()
        self.inputs.note_command(
            "switch",
            ticket,
            start=tuple(request.start),
            stop=tuple(request.stop),
            strictness=request.strictness.value,
            start_asap=request.start_asap,
            timeout=request.timeout,
        )
        return self.manager.switch_controller(replace(request, ticket=ticket))

    def set_hardware_component_state(
        self, name: str, state: ComponentState, *, stop_controllers: bool = False
    ) -> HardwareComponentReport:
        """Bring a hardware component into a state of its life cycle.

        Args:
            name: The component.
            state: The new state.
            stop_controllers: Whether to stop first the controllers that command the
                component, and the controllers that command these, if it is to leave the
                active state.

        Raises:
            HardwareComponentNotFoundError: There is no such component.
            HardwareComponentError: It is in use or finalized, or a hook refuses.
            SwitchRefusedError: Its controllers cannot be stopped.
            SwitchTimeoutError: Its controllers cannot be stopped in time.
            LoopError: The loop died.
        """
        self.loop.check_alive()
        users = self.manager.hardware_users(name)
        if stop_controllers and users and state is not ComponentState.ACTIVE:
            self.switch_controllers(
                SwitchRequest(stop=users, strictness=Strictness.AUTO)
            )
        self.manager.set_hardware_component_state(name, state)
        self.inputs.note("hardware", name=name, state=state.value)
        found = self.manager.hardware_components()
        return next(one for one in found if one.name == name)

    def controller_sample(self, name: str) -> ControllerSample | None:
        """Return the sample of a controller's last update; None before the first.

        Raises:
            ControllerNotFoundError: No controller of that name is loaded.
        """
        return self.manager.get_controller(name).sample

    def published(self, name: str) -> Mapping[str, Mapping[str, object]]:
        """Return the latest messages of a controller by topic.

        Raises:
            ControllerNotFoundError: No controller of that name is loaded.
        """
        return self.manager.get_controller(name).published()

    def stop(self, reason: str) -> None:
        """Stop every controller in the next cycle; nothing moves until it is armed."""
        self.loop.stop_latch.engage(reason)
        self.inputs.note_stop(reason)
        if self.loop.state is not LoopState.RUNNING:
            self.loop.control_cycle.carry_out_stop(self.loop.failure_summary())

    def stop_from_cycle(self, reason: str) -> None:
        """Stop every controller in the next cycle; control thread only."""
        self.loop.stop_latch.engage(reason)
        self.inputs.note_stop(reason)

    def release_stop(self, *, arm: bool) -> StopState:
        """Release the latched stop; with `arm`, allow motion again.

        Raises:
            StoppedError: `arm` is true and the stop is not released, or the stop is to
                be released and the loop has not carried it out.
        """
        latch, clock = self.loop.stop_latch, self.loop.clock
        deadline = clock.now() + FRESH
        while latch.pending and clock.now() < deadline:
            clock.sleep_until(clock.now() + self.loop.period)
        if arm:
            latch.arm()
        else:
            latch.release()
        self.inputs.note("release", arm=arm)
        return latch.state

    def _wanted_parameters(
        self,
        name: str,
        controller_type: str | None,
        params: Mapping[str, object] | None,
        before: object,
    ) -> dict[str, object]:
        known = {} if before is None else before
        if name in self._reserved or not isinstance(known, dict):
            raise ParameterError(
                f"'{name}' is a parameter of the station and no controller's.",
                remedy="Choose another name for the controller.",
                details={"parameter": name},
            )
        wanted = dict(known if params is None else params)
        chosen = controller_type or wanted.get("type") or known.get("type")
        if not isinstance(chosen, str):
            raise ParameterError(
                f"Controller '{name}' has no type.",
                remedy="Name its type, one of those that can be loaded"
                f"{self._configured(name)}",
                details={"parameter": f"{name}/type"},
            )
        return {**wanted, "type": chosen}

    def _configured(self, name: str) -> str:
        """Return the end of a remedy, which tells the controllers with a type."""
        tree = self.parameters.get("")
        typed = [
            key
            for key, value in (tree if isinstance(tree, dict) else {}).items()
            if key not in self._reserved and isinstance(value, dict) and "type" in value
        ]
        return f", or a configured controller. {suggest(name, typed)}" if typed else "."

    def _restore(self, name: str, before: object) -> None:
        if before is None:
            self.parameters.tree.delete(self.parameters.resolve(name))
        else:
            self.parameters.set(name, before)
