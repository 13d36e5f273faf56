"""A shipped robot without hardware, for tests, examples and dry runs.

Its joints are ideal. A script can order every fault of a robot: refused, slow and
failing switches, sensors that read NaN, slow cycles, exceptions.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from typing_extensions import override

from station.core.clock import Clock, SystemClock
from station.core.errors import (
    HardwareInterfaceError,
    ParameterError,
    SwitchRefusedError,
)
from station.core.hardware.interfaces import (
    EffortJointInterface,
    ForceTorqueSensorHandle,
    ForceTorqueSensorInterface,
    ImuSensorHandle,
    ImuSensorInterface,
    JointHandle,
    JointStateHandle,
    JointStateInterface,
    PositionJointInterface,
    PosVelAccJointHandle,
    PosVelAccJointInterface,
    PosVelJointHandle,
    PosVelJointInterface,
    ValuesSensorHandle,
    VelocityJointInterface,
)
from station.core.hardware.interfaces.sensors import (
    SEMANTIC_INTERFACES,
    SEMANTIC_VALUES,
)
from station.core.hardware.robot_hw import (
    ControllerInfo,
    RobotHW,
    SimulatedWorld,
    SwitchState,
)
from station.core.parameters import Parameters
from station.hw.simulated_gpios import SimulatedGpios, read_gpios

POSITION_MODES = frozenset({
    PositionJointInterface.type_name,
    PosVelJointInterface.type_name,
    PosVelAccJointInterface.type_name,
})
"""Modes in which a joint goes to its commanded position."""
IDLE = ""
"""Mode of a joint that no controller claims; the joint stands still."""


class MockJoints:
    """Ideal joints, which follow their commands at once.

    With a position command a joint is at that position at once, with a velocity command
    it moves at that velocity, with an effort command it accelerates by effort minus
    friction over inertia, and without a command it stands still.

    Args:
        positions: Initial positions [rad or m], shape (n,).
        inertia: Inertia of every joint [kg m^2 or kg], > 0.
        damping: Viscous friction of every joint [Nm s/rad or N s/m], >= 0.

    Attributes:
        position, velocity, effort: The true state, shape (n,).
        position_command, velocity_command, acceleration_command, effort_command: The
            commands of controllers, shape (n,).
        mode: Name of the interface that commands each joint; `IDLE` if none does.
    """

    def __init__(
        self, positions: list[float], inertia: float = 1.0, damping: float = 1.0
    ) -> None:
        count = len(positions)
        self.position = list(positions)
        self.velocity = [0.0] * count
        self.effort = [0.0] * count
        self.position_command = list(positions)
        self.velocity_command = [0.0] * count
        self.acceleration_command = [0.0] * count
        self.effort_command = [0.0] * count
        self.mode = [IDLE] * count
        self._inertia = inertia
        self._damping = damping

    def place(self, positions: list[float]) -> None:
        """Put the joints at rest at a pose, which becomes their commanded pose as well.

        Args:
            positions: Positions [rad or m], shape (n,).
        """
        self.position[:] = self.position_command[:] = positions
        for values in (
            self.velocity,
            self.effort,
            self.velocity_command,
            self.acceleration_command,
            self.effort_command,
        ):
            values[:] = [0.0] * len(positions)

    def advance(self, period: float) -> None:
        """Let `period` [s] pass, >= 0."""
        for index, mode in enumerate(self.mode):
            if mode in POSITION_MODES:
                self._follow_position(index, period)
            elif mode == VelocityJointInterface.type_name:
                self._move(index, self.velocity_command[index], period)
            elif mode == EffortJointInterface.type_name:
                self._accelerate(index, period)
            else:
                self._move(index, 0.0, period)

    def _follow_position(self, index: int, period: float) -> None:
        before = self.position[index]
        self.position[index] = self.position_command[index]
        step = self.position[index] - before
        self.velocity[index] = step / period if period > 0.0 else 0.0
        self.effort[index] = 0.0

    def _move(self, index: int, velocity: float, period: float) -> None:
        self.velocity[index] = velocity
        self.position[index] += velocity * period
        self.effort[index] = 0.0

    def _accelerate(self, index: int, period: float) -> None:
        self.effort[index] = self.effort_command[index]
        # Implicit in the friction, and so stable for every period.
        momentum = self.velocity[index] + self.effort[index] * period / self._inertia
        velocity = momentum / (1.0 + self._damping * period / self._inertia)
        self.velocity[index] = velocity
        self.position[index] += velocity * period


class MockWorld(SimulatedWorld):
    """Advances ideal joints in time. Control thread only.

    Args:
        names: Names of the joints.
        joints: The joints; a reset restores their present positions.
    """

    def __init__(self, names: Sequence[str], joints: MockJoints) -> None:
        self._names = tuple(names)
        self._joints = joints
        self._start = list(joints.position)
        self._time = 0.0

    def advance(self, period: float) -> None:
        """Let `period` [s] pass, >= 0."""
        self._time += period
        self._joints.advance(period)

    @override
    def time(self) -> float:
        return self._time

    @override
    def reset(self, positions: Mapping[str, float]) -> None:
        places = {self._index(name): value for name, value in positions.items()}
        self._time = 0.0
        self._joints.place([
            places.get(index, start) for index, start in enumerate(self._start)
        ])

    def _index(self, joint: str) -> int:
        if joint not in self._names:
            raise HardwareInterfaceError(
                f"The mock has no joint '{joint}'.",
                remedy=f"Choose among {', '.join(self._names)}.",
                details={"joint": joint},
            )
        return self._names.index(joint)


@dataclass(slots=True)
class MockScript:
    """The faults of the mock; by default there are none.

    Attributes:
        refusal: Why `prepare_switch` refuses; None to accept every switch.
        switch_cycles: Cycles that every switch of the hardware takes, >= 0.
        failing: Names of controllers for which the hardware cannot switch.
        nan_sensors: Names of joints whose position and velocity read NaN.
        slow_cycles: Durations of the next cycles in `read` [s].
        read_error: Error that `read` raises; None for no error.
        mode: The robot's mode, one word.
    """

    refusal: str | None = None
    switch_cycles: int = 0
    failing: set[str] = field(default_factory=set)
    nan_sensors: set[str] = field(default_factory=set)
    slow_cycles: list[float] = field(default_factory=list)
    read_error: Exception | None = None
    mode: str = "running"


class MockRobotHW(RobotHW):
    """Type `mock_hw/MockRobotHW`.

    Parameters, all optional: `joints` (list of names), `initial_positions` (one number
    per joint), `inertia`, `damping`, `switch_cycles` (see `MockScript`), `sensors`
    (`type` of `SEMANTIC_INTERFACES`, `frame_id`, `values`) and `gpios` (see
    `simulated_gpios`).

    Attributes:
        script: Faults to come; may be changed at any time between two cycles.
        switches: (started, stopped) names of every `do_switch`, oldest first.
        clock: Clock by which slow cycles wait.
        sensor_values: Values of each sensor, in the order of their names in `sensors`;
            may be changed between two cycles.
        gpios: Inputs and outputs.
    """

    def __init__(self) -> None:
        super().__init__()
        self.script = MockScript()
        self.switches: list[tuple[tuple[str, ...], tuple[str, ...]]] = []
        self.clock: Clock = SystemClock()
        self.joint_names: list[str] = []
        self.joints = MockJoints([])
        self.sensor_values: dict[str, list[float]] = {}
        self.gpios = SimulatedGpios(())
        self._ready_in: dict[str, int] = {}
        self._measured = MockJoints([])
        self._world = MockWorld([], self.joints)

    @override
    def init(self, root_params: Parameters, hw_params: Parameters) -> None:
        """Make the joints and register their interfaces.

        Args:
            root_params: Not used.
            hw_params: The parameters named above.

        Raises:
            ParameterError: A parameter is impossible.
        """
        names = hw_params.get_str_list("joints", ["joint1", "joint2"])
        if len(set(names)) != len(names):
            raise ParameterError(
                f"Parameter '{hw_params.resolve('joints')}' names a joint twice: "
                f"{', '.join(names)}.",
                remedy="Give every joint its own name.",
            )
        positions = hw_params.get_float_list(
            "initial_positions", len(names), [0.0] * len(names)
        )
        inertia = hw_params.get_float("inertia", 1.0)
        damping = hw_params.get_float("damping", 1.0)
        if inertia <= 0.0 or damping < 0.0:
            raise ParameterError(
                f"Inertia {inertia} and damping {damping} of the mock must be > 0 and "
                ">= 0.",
                remedy="Leave them out for the defaults.",
            )
        self.script.switch_cycles = hw_params.get_int("switch_cycles", 0)
        self.joint_names = names
        self.joints = MockJoints(positions, inertia, damping)
        self._world = MockWorld(names, self.joints)
        self._measured = MockJoints(positions)
        self._register_interfaces()
        self._register_devices(hw_params)

    def _register_devices(self, hw_params: Parameters) -> None:
        """Register the sensors with named values, and the inputs and outputs.

        Raises:
            ParameterError: A sensor is of an unknown type, or a value is impossible.
        """
        named = {kind: make() for kind, make in SEMANTIC_INTERFACES.items()}
        sensors = hw_params.namespace("sensors")
        for name in sensors.keys():  # noqa: SIM118 - no mapping
            entry = sensors.namespace(name)
            kind = entry.get_str("type")
            if kind not in named:
                raise ParameterError(
                    f"Parameter '{entry.resolve('type')}' is '{kind}'; it must be one "
                    f"of {', '.join(named)}.",
                    remedy="Correct the configuration.",
                )
            given = entry.namespace("values")
            keys = dict.fromkeys((*SEMANTIC_VALUES[kind], *given.keys()))
            values = [given.get_float(key, 0.0) for key in keys]
            self.sensor_values[name] = values
            frame = entry.get_str("frame_id", "")
            named[kind].register_handle(ValuesSensorHandle(name, frame, values, keys))
        self.gpios = SimulatedGpios(read_gpios(hw_params))
        offered = [each for each in named.values() if each.get_names()]
        for interface in (*offered, *self.gpios.interfaces()):
            self.register_interface(interface)

    def _register_interfaces(self) -> None:
        seen, true = self._measured, self.joints
        position, velocity = true.position_command, true.velocity_command
        states = JointStateInterface()
        positions, velocities = PositionJointInterface(), VelocityJointInterface()
        efforts = EffortJointInterface()
        pos_vels, pos_vel_accs = PosVelJointInterface(), PosVelAccJointInterface()
        for index, name in enumerate(self.joint_names):
            state = JointStateHandle(
                name, seen.position, seen.velocity, seen.effort, index
            )
            states.register_handle(state)
            positions.register_handle(JointHandle(state, position))
            velocities.register_handle(JointHandle(state, velocity))
            efforts.register_handle(JointHandle(state, true.effort_command))
            pos_vels.register_handle(PosVelJointHandle(state, position, velocity))
            pos_vel_accs.register_handle(
                PosVelAccJointHandle(
                    state, position, velocity, true.acceleration_command
                )
            )
        for interface in (
            states,
            positions,
            velocities,
            efforts,
            pos_vels,
            pos_vel_accs,
        ):
            self.register_interface(interface)
        self._register_sensors()

    def _register_sensors(self) -> None:
        wrench = ForceTorqueSensorInterface()
        wrench.register_handle(
            ForceTorqueSensorHandle("mock_wrench", "tool0", [0.0] * 3, [0.0] * 3)
        )
        imu = ImuSensorInterface()
        imu.register_handle(
            ImuSensorHandle(
                "mock_imu",
                "base_link",
                orientation=[0.0, 0.0, 0.0, 1.0],
                angular_velocity=[0.0] * 3,
                linear_acceleration=[0.0, 0.0, 9.81],
            )
        )
        self.register_interface(wrench)
        self.register_interface(imu)

    @override
    def read(self, time: float, period: float) -> None:
        script = self.script
        if script.slow_cycles:
            self.clock.sleep_until(self.clock.now() + script.slow_cycles.pop(0))
        if script.read_error is not None:
            raise script.read_error
        if period > 0.0:
            self._world.advance(period)
        seen, true = self._measured, self.joints
        seen.position[:] = true.position
        seen.velocity[:] = true.velocity
        seen.effort[:] = true.effort
        for index, name in enumerate(self.joint_names):
            if name in script.nan_sensors:
                seen.position[index] = seen.velocity[index] = math.nan

    @override
    def write(self, time: float, period: float) -> None:
        self.gpios.write()
        for name, cycles in self._ready_in.items():
            if cycles > 0:
                self._ready_in[name] = cycles - 1

    @override
    def prepare_switch(
        self, start: Sequence[ControllerInfo], stop: Sequence[ControllerInfo]
    ) -> None:
        """Refuse the switch if the script says so.

        Args:
            start: Controllers that will be started.
            stop: Controllers that will be stopped.

        Raises:
            SwitchRefusedError: `script.refusal` is set.
        """
        if self.script.refusal is not None:
            raise SwitchRefusedError(
                f"The mock refuses the switch: {self.script.refusal}.",
                remedy="Clear the refusal in its script.",
            )

    @override
    def do_switch(
        self, start: Sequence[ControllerInfo], stop: Sequence[ControllerInfo]
    ) -> None:
        self.switches.append((
            tuple(info.name for info in start),
            tuple(info.name for info in stop),
        ))
        for info in stop:
            self._set_mode(info, claimed=False)
            self._ready_in.pop(info.name, None)
        for info in start:
            self._set_mode(info, claimed=True)
            self._ready_in[info.name] = self.script.switch_cycles

    def _set_mode(self, info: ControllerInfo, *, claimed: bool) -> None:
        for claim in info.claimed_resources:
            for resource in claim.resources:
                if resource in self.joint_names:
                    index = self.joint_names.index(resource)
                    mode = claim.hardware_interface if claimed else IDLE
                    self.joints.mode[index] = mode

    @override
    def switch_result(self) -> SwitchState:
        if self.script.failing:
            return SwitchState.ERROR
        waiting = any(cycles > 0 for cycles in self._ready_in.values())
        return SwitchState.ONGOING if waiting else SwitchState.DONE

    @override
    def switch_result_for(self, controller: ControllerInfo) -> SwitchState:
        if controller.name in self.script.failing:
            return SwitchState.ERROR
        waiting = self._ready_in.get(controller.name, 0) > 0
        return SwitchState.ONGOING if waiting else SwitchState.DONE

    @override
    def simulated_world(self) -> SimulatedWorld:
        return self._world

    @override
    def mode(self) -> str:
        return self.script.mode
