"""MujocoRobotHW: any robot that has a URDF, simulated.

Source: gazebo_ros_control@2.9.2 default_robot_hw_sim.cpp, DefaultRobotHWSim; differs:

- The motors are on the actuator side of the transmissions (`simulated_motors`).
- Every joint with a motor takes effort, velocity and position commands.
- Without `pid_gains` a joint follows positions and velocities by a servo whose force
  is limited (`joint_drives`); it does not jump to the command.
- A joint that no controller commands holds its position.
- Mimic joints and joints without a motor have a state, too.
"""

import logging
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from math import ceil, inf

from typing_extensions import override

from station.core.description.robot_description import ROBOT_DESCRIPTION
from station.core.description.robot_files import RobotFiles, load_robot_files
from station.core.description.ros2_control import ComponentTag, HardwareTag
from station.core.description.srdf import group_states
from station.core.description.urdf import JointType, Urdf
from station.core.description.urdf_repair import Repair
from station.core.errors import (
    HardwareInterfaceError,
    ParameterError,
    RobotDescriptionError,
    SwitchRefusedError,
)
from station.core.geometry.scene import read_scene
from station.core.hardware.interfaces import JointHandle, JointStateInterface
from station.core.hardware.limits import joint_limits_from_parameters
from station.core.hardware.robot_hw import ControllerInfo, HardwareComponent, RobotHW
from station.core.hardware.robot_report import ClampReport, JointLimitsReport
from station.core.hardware.transmissions import (
    ActuatorToJointStateInterface,
    JointToActuatorEffortInterface,
    JointToActuatorPositionInterface,
    JointToActuatorVelocityInterface,
    RobotTransmissions,
    TransmissionInfo,
    TransmissionInterfaceLoader,
)
from station.core.hardware.transmissions.transmission_interface_loader import (
    interface_of,
)
from station.core.parameters import Parameters
from station.hw.mujoco.bases import RollingBase, joints_of_base
from station.hw.mujoco.description_repair import log_repairs, repair_robot
from station.hw.mujoco.joint_command_limits import JointCommandLimits
from station.hw.mujoco.joint_command_modes import (
    COMMAND_INTERFACES,
    JointCommandModes,
    read_simulated_pids,
)
from station.hw.mujoco.joint_drives import JointDrives
from station.hw.mujoco.mujoco_robot_parameters import (
    MujocoRobotParameters,
    read_parameters,
)
from station.hw.mujoco.mujoco_simulation import simulate_robot
from station.hw.mujoco.robot_guard import RobotGuard
from station.hw.mujoco.robot_transmissions import read_transmissions
from station.hw.mujoco.ros2_control_tags import TaggedRobot, read_tagged_robot
from station.hw.mujoco.sensors import WorldSensors
from station.hw.mujoco.shared_world import SharedWorld
from station.hw.mujoco.simulated_motors import SimulatedMotors
from station.hw.mujoco.stops_and_brakes import add_hard_stops
from station.hw.mujoco.world import World
from station.hw.mujoco.world_joints import UnpoweredJoints
from station.hw.simulated_gpios import SimulatedGpios
from station.hw.urdf_loader import load_urdf
from station.memory.doubles import put
from station.reports import HardwareTransmission

# Most steps of the world in one cycle, unless two cycles of the loop need more. Further
# steps are lost, so that a very late cycle does not make the next cycle late, too.
_MOST_STEPS_AT_ONCE = 20
# Relative difference between a cycle and its steps that gives a warning.
_UNEVEN = 0.01
_logger = logging.getLogger(__name__)
_ToActuators = (
    JointToActuatorPositionInterface
    | JointToActuatorVelocityInterface
    | JointToActuatorEffortInterface
)


class MujocoRobotHW(RobotHW):
    """Type `mujoco_hw/MujocoRobotHW`.

    Interfaces: state and commands of joints and of actuators, force-torque sensors and
    inertial measurement units. Efforts are the efforts of the motors, without the
    effort that compensates gravity.

    Parameters are those of `mujoco_robot_parameters`. `init` stores the URDF as
    `robot_description` in the root namespace if there is none yet.

    Attributes:
        world: The simulated world; control thread only, from `init` on.
        transmission_maps: The maps between actuators and joints; from `init` on.
        lost_steps: Steps of the world that were left out because cycles were late.
    """

    world: World

    def __init__(self) -> None:
        super().__init__()
        self.lost_steps = 0
        self._time_due = 0.0
        self._most_steps = _MOST_STEPS_AT_ONCE

    @override
    def init(self, root_params: Parameters, hw_params: Parameters) -> None:
        """Set the robot up with the parameters that the class names.

        Args:
            root_params: Receives the URDF; may also hold `joint_limits`.
            hw_params: The robot's parameters.

        Raises:
            JointLimitsError: A joint's limits are contradictory.
            ParameterError: A parameter is missing, unknown or impossible.
            RobotDescriptionError: The URDF cannot be used; the message names the file,
                the element and the reason.
        """
        parameters = read_parameters(hw_params)
        tagged = _read_tags(parameters)
        parameters = replace(
            parameters,
            sensors=tagged.sensors,
            initial_positions={**tagged.positions, **parameters.initial_positions},
        )
        self._hardware = tagged.hardware
        description = tagged.description
        limited = hw_params if hw_params.has("joint_limits") else root_params
        repaired = repair_robot(
            description,
            strict=parameters.strict,
            zero_range=parameters.zero_range,
            base=parameters.base_type,
            find_effort=lambda joint: _effort_of(joint, limited),
        )
        description, urdf = repaired.description, repaired.urdf
        transmissions = read_transmissions(description, urdf)
        if not transmissions and parameters.strict:
            raise RobotDescriptionError(
                f"{description.urdf_path}: <robot>: has no joint that could be driven.",
                remedy="Add joints that move and whose effort limit is above 0.",
            )
        simulated = simulate_robot(
            description, urdf, parameters, read_scene(root_params)
        )
        self.world = simulated.world
        if simulated.base != parameters.base:  # the dashboard reads it from there
            hw_params.set("base_xyz", list(simulated.base.xyz))
        self._repairs = (*repaired.repairs, *simulated.repairs, *tagged.repairs)
        log_repairs(description, self._repairs)
        if not root_params.has(ROBOT_DESCRIPTION):
            root_params.set(ROBOT_DESCRIPTION, description.xml)
        if parameters.base_type == "planar":
            self.world.add_preparation(RollingBase(self.world, urdf))
        self._make_motors(description, transmissions)
        self._transmission_reports = [_report(info) for info in transmissions]
        pids = read_simulated_pids(hw_params, {n: urdf.joints[n] for n in self._names})
        self._modes = JointCommandModes(self._joints, pids, self._drives.modes)
        self._unpowered = UnpoweredJoints(
            self.world.model,
            self.world.data,
            [*joints_of_base(parameters.base_type), *_others(urdf, self._names)],
            interface_of(self, JointStateInterface),
        )
        self._limits = JointCommandLimits(
            # From the description, because `urdf` has other effort limits already.
            load_urdf(description).joints,
            limited,
            parameters.limit_mode,
            tagged.limited,
        )
        self._add_limits(urdf)
        self._add_devices(parameters, (*tagged.gpios, *parameters.gpios))
        if tagged.hardware:
            self._offer_only(tagged.commands)
        self.read(0.0, 0.0)
        self._modes.restart()
        keyframes = {
            name: {joint: p for joint, p in state.items() if joint in self._names}
            for name, state in group_states(description.srdf_path).items()
        }
        # The guard cannot know what a moving base comes near to.
        is_fixed = parameters.base_type == "fixed"
        self._guard = self._make_guard(hw_params, urdf) if is_fixed else None
        self._shared_world = SharedWorld(self.world, keyframes)
        self._shared_world.add_robot(self)

    @override
    def mode(self) -> str:
        return "diverged" if self.world.diverged_because else "running"

    @override
    def read(self, time: float, period: float) -> None:
        """Let `period` pass in the world, then read joints, actuators and sensors."""
        self._advance(period)
        motors, world_joints = self._motors, self._world_joints
        put(motors.joint_state["position"], world_joints.read_positions())
        put(motors.joint_state["velocity"], world_joints.read_velocities())
        put(motors.joint_state["effort"], world_joints.read_motor_forces())
        motors.update_state()
        self._state_interface.propagate()
        self._unpowered.read()
        self._sensors.read()

    @override
    def write(self, time: float, period: float) -> None:
        """Limit the commands and hand them to the motors for the steps to come."""
        if period <= 0.0:
            return
        if self._gpios is not None:
            self._gpios.write()
        if self._modes.release_bad_commands():
            self._limits.activate(self._modes.in_use)
        self._limits.enforce(period)
        if self._guard is not None and self._guard.is_active:
            self._guard.limit(period)
        self._modes.command_joints(period)
        for quantity in self._modes.quantities:
            self._to_actuators[quantity].propagate()
            self._motors.act(quantity)

    @override
    def components(self) -> Sequence[HardwareComponent]:
        """Return one component per `<ros2_control>` element; without any, `robot`."""
        if not self._hardware:
            return super().components()
        return [
            HardwareComponent(
                one.name, self, one.type, one.plugin, frozenset(_resources_of(one))
            )
            for one in self._hardware
        ]

    @override
    def joint_limits(self) -> Sequence[JointLimitsReport]:
        return self._limits.reports

    @override
    def transmissions(self) -> Sequence[HardwareTransmission]:
        return self._transmission_reports

    @override
    def repairs(self) -> Sequence[Repair]:
        return self._repairs

    @override
    def clamps(self) -> Sequence[ClampReport]:
        return [*self._limits.clamps(), *self.world.brakes.clamps(self._names)]

    @override
    def check_period(self, period: float) -> None:
        """Refuse a loop faster than the simulation; warn when steps do not fit a cycle.

        Args:
            period: Nominal period of the loop [s], > 0.

        Raises:
            HardwareInterfaceError: The period is shorter than the simulation's time
                step.
        """
        timestep, rate = self.world.timestep, 1.0 / period
        steps = period / timestep
        if steps < 1.0 - _UNEVEN:
            raise HardwareInterfaceError(
                f"The loop runs at {rate:g} Hz; the simulation makes only "
                f"{1.0 / timestep:g} steps per second, one every {timestep:g} s.",
                remedy=f"Set robot.timestep to {period:g} or less, or station.rate to "
                f"{1.0 / timestep:g} or less.",
                details={"rate": rate, "timestep": timestep},
            )
        self._most_steps = max(_MOST_STEPS_AT_ONCE, 2 * round(steps))
        if abs(steps - round(steps)) > _UNEVEN:
            _logger.warning(
                "a cycle at %g Hz takes %.3g steps of %g s: some cycles make one step "
                "more than others; a timestep of %g s would fit",
                rate,
                steps,
                timestep,
                period / ceil(steps),
            )

    @override
    def prepare_switch(
        self, start: Sequence[ControllerInfo], stop: Sequence[ControllerInfo]
    ) -> None:
        """Check that the simulation can run, and that the guard can slow commands.

        Raises:
            SwitchRefusedError: The simulation has diverged, or efforts would command
                joints while the scene has roles.
        """
        if self._guard is not None and self._guard.is_active:
            try:
                self._guard.refuse_efforts(self._modes.efforts_of(start))
            except ParameterError as error:
                raise SwitchRefusedError(error.message, remedy=error.remedy) from error
        if start and self.world.diverged_because is not None:
            raise SwitchRefusedError(
                f"The robot stands still: {self.world.diverged_because}.",
                remedy="Reset the simulation.",
            )

    @override
    def do_switch(
        self, start: Sequence[ControllerInfo], stop: Sequence[ControllerInfo]
    ) -> None:
        self._modes.switch(start, stop)
        self._limits.activate(self._modes.in_use)

    @override
    def guards(self) -> Sequence[RobotGuard]:
        return () if self._guard is None else (self._guard,)

    @override
    def simulated_world(self) -> SharedWorld:
        return self._shared_world

    def begin_anew(self) -> None:
        """Hold the pose to which the world was reset."""
        self.read(0.0, 0.0)
        self._modes.restart()
        self._limits.reset()
        if self._guard is not None:
            self._guard.restart()
        if self._gpios is not None:
            self._gpios.reset()

    def longest_period(self) -> float:
        """Return infinity: the world does not wait for the loop."""
        return inf

    def _advance(self, period: float) -> None:
        world = self.world
        self._time_due += period
        steps = round(self._time_due / world.timestep)
        self._time_due -= steps * world.timestep
        for _ in range(min(steps, self._most_steps)):
            world.step()
        self.lost_steps += max(0, steps - self._most_steps)

    def _make_motors(
        self, description: RobotFiles, infos: list[TransmissionInfo]
    ) -> None:
        self._names = [joint.name for info in infos for joint in info.joints]
        self._world_joints = self.world.joints(self._names)
        self._drives = JointDrives(self._world_joints, self.world.timestep)
        self.world.add_actor(self._drives, self._drives)
        actuators = [actuator.name for info in infos for actuator in info.actuators]
        self._motors = SimulatedMotors(actuators, self._names, self._drives.targets)
        self._motors.register(self)
        self.transmission_maps = RobotTransmissions()
        loader = TransmissionInterfaceLoader(
            self, self.transmission_maps, joints=self._names
        )
        for info in infos:
            self._load(loader, info, description)
        self._joints = loader.raw_joint_data
        self._state_interface = interface_of(
            self.transmission_maps, ActuatorToJointStateInterface
        )
        self._to_actuators: dict[str, _ToActuators] = {
            "position": interface_of(
                self.transmission_maps, JointToActuatorPositionInterface
            ),
            "velocity": interface_of(
                self.transmission_maps, JointToActuatorVelocityInterface
            ),
            "effort": interface_of(
                self.transmission_maps, JointToActuatorEffortInterface
            ),
        }

    def _make_guard(self, hw_params: Parameters, urdf: Urdf) -> RobotGuard | None:
        guard = RobotGuard(
            hw_params.path.rpartition("/")[2] or urdf.name,
            self.world.model,
            self.world.data,
            urdf=urdf,
            driven=self._world_joints,
            joints=self._joints,
            modes=self._modes,
            limits={one.joint: one.limits for one in self._limits.reports},
        )
        # Without a motor or collision geometry it would have no effect.
        return guard if self._names and guard.links() else None

    def _add_devices(
        self, parameters: MujocoRobotParameters, gpios: Sequence[ComponentTag]
    ) -> None:
        """Make the sensors, and the inputs and outputs."""
        model, data = self.world.model, self.world.data
        self._sensors = WorldSensors(model, data, parameters.sensors)
        self._gpios = SimulatedGpios(gpios) if gpios else None
        interfaces: list[object] = [*self._sensors.interfaces()]
        interfaces += [] if self._gpios is None else self._gpios.interfaces()
        for interface in interfaces:
            self.register_interface(interface)

    def _offer_only(self, commands: Mapping[str, frozenset[str]]) -> None:
        """Offer the command interfaces that the description names, and no others.

        Args:
            commands: Quantities by joint.
        """
        for quantity, interface in COMMAND_INTERFACES.items():
            offered = interface()
            for handle in interface_of(self, interface).handles():
                if quantity in commands.get(handle.name, ()):
                    offered.register_handle(handle)
            self.register_interface(offered)

    def _load(
        self,
        loader: TransmissionInterfaceLoader,
        info: TransmissionInfo,
        description: RobotFiles,
    ) -> None:
        """Load one transmission.

        Raises:
            RobotDescriptionError: The transmission cannot be loaded for all of its
                interfaces.
        """
        where = f'{description.urdf_path}: <transmission name="{info.name}">: '
        try:
            loader.load(info)
        except HardwareInterfaceError as exc:
            raise RobotDescriptionError(
                f"{where}{exc.message}", remedy=exc.remedy
            ) from exc
        if loader.problems:
            raise RobotDescriptionError(
                f"{where}{loader.problems[0]}",
                remedy="Correct that element of the URDF.",
            )
        self._motors.connect(info, loader.loaded[-1].transmission)

    def _add_limits(self, urdf: Urdf) -> None:
        commands: dict[str, dict[str, JointHandle]] = {n: {} for n in self._names}
        for quantity, interface in COMMAND_INTERFACES.items():
            # Without `get_handle`, which would claim the joints.
            for handle in interface_of(self, interface).handles():
                commands[handle.name][quantity] = handle
        for name, handles in commands.items():
            self._limits.add(name, handles)
        velocities = self._limits.velocities()
        put(self._drives.velocity_limits, [velocities[name] for name in self._names])
        limits = velocities | _velocities_of_mimics(urdf)
        self.world.limit_velocities(limits)
        add_hard_stops(self.world, limits)


def _read_tags(parameters: MujocoRobotParameters) -> TaggedRobot:
    """Return the robot with the settings of its URDF's `<ros2_control>` elements."""
    files = load_robot_files(parameters.robot_description)
    if not parameters.uses_ros2_control:
        return TaggedRobot(files, (), {}, {}, {}, parameters.sensors, (), ())
    return read_tagged_robot(files, parameters.sensors, strict=parameters.strict)


def _resources_of(hardware: HardwareTag) -> Iterator[str]:
    for tag in (*hardware.joints, *hardware.sensors):
        yield tag.name
    for tag in hardware.gpios:
        for one in (*tag.commands, *tag.states):
            yield f"{tag.name}/{one.name}"


def _effort_of(joint: str, limited: Parameters) -> float | None:
    """Return the effort limit of a joint in `joint_limits`; None without one."""
    limits = joint_limits_from_parameters(joint, limited)
    effort = None if limits is None else limits.max_effort
    # A negative limit is refused with the other limits of the joint.
    return effort if effort is not None and effort >= 0.0 else None


def _others(urdf: Urdf, driven: Sequence[str]) -> list[str]:
    """Return the joints that move but have no motor."""
    moving = (joint.name for joint in urdf.joints.values() if joint.type.moves)
    return [name for name in moving if name not in driven]


def _velocities_of_mimics(urdf: Urdf) -> dict[str, float]:
    return {
        joint.name: joint.limit.velocity
        for joint in urdf.joints.values()
        if joint.type is not JointType.FIXED
        and joint.mimic is not None
        and joint.limit is not None
        and joint.limit.velocity > 0.0
    }


def _report(info: TransmissionInfo) -> HardwareTransmission:
    return HardwareTransmission(
        info.name,
        info.type,
        tuple(joint.name for joint in info.joints),
        tuple(actuator.name for actuator in info.actuators),
    )
