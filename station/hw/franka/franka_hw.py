"""FrankaHW: one Franka arm as the controller manager sees it.

Source: franka_ros@c11f000 franka_hw/src/franka_hw.cpp, FrankaHW; differs:

- A switch that does not change the arm's mode does not interrupt the running motion,
  unless a new controller commands a Cartesian motion.
- A switch to a Cartesian motion is ongoing until the arm has come to rest.
- At a switch the command buffers are set to the present state, so that no old command
  is sent before a controller's first command.
- Limits are enforced only for the kinds of command that controllers give.
- A command or a reading that is not finite stops the arm's motion instead of the
  process.
- A late loop loses packets; with `realtime_config: ignore` the world and the station's
  time wait for the loop.
- An unsupported mode is refused with its reason, before any controller is stopped.
"""

import logging
from collections.abc import Sequence
from dataclasses import replace
from math import degrees, inf
from typing import TYPE_CHECKING

from typing_extensions import override

from station.core.description.robot_description import ROBOT_DESCRIPTION
from station.core.description.urdf import Joint, Urdf
from station.core.errors import (
    HardwareInterfaceError,
    ParameterError,
    SwitchRefusedError,
)
from station.core.franka import (
    FrankaModel,
    FrankaModelHandle,
    FrankaModelInterface,
    FrankaServicesInterface,
    FrankaStateHandle,
    FrankaStateInterface,
)
from station.core.franka.franka_robot_state import MODE, RobotMode, RobotState
from station.core.hardware.robot_hw import (
    ControllerInfo,
    HardwareComponent,
    ResourceConflict,
    RobotClock,
    RobotHW,
    SwitchState,
)
from station.core.hardware.robot_report import ClampReport, JointLimitsReport
from station.core.parameters import Parameters
from station.hw.franka.arm.arm_description import (
    find_prefix,
    joint_names,
    load_arm_description,
)
from station.hw.franka.arm.control_mode import (
    ControlMode,
    control_mode_of,
    find_conflicts,
    is_supported,
)
from station.hw.franka.arm.robot_arm import MOST_LOST_PACKETS, RobotArm
from station.hw.franka.commands.arm_guard import ArmGuard
from station.hw.franka.commands.arm_reading import ArmReading
from station.hw.franka.commands.arm_services import ArmServices
from station.hw.franka.commands.cartesian_commands import CartesianCommands
from station.hw.franka.commands.command_sender import CommandSender
from station.hw.franka.commands.joint_commands import JointCommands
from station.hw.franka.commands.motion_start import MotionStart
from station.hw.franka.commands.rate_limiter import (
    make_joint_rates,
    make_velocity_curves,
    rate_limits_of,
)
from station.hw.franka.franka_parameters import (
    FrankaParameters,
    read_command_settings,
    read_parameters,
)
from station.hw.franka.hand.finger_joints import FingerJoints
from station.hw.urdf_loader import load_urdf
from station.memory.direct_calls import call_directly

if TYPE_CHECKING:
    from station.hw.franka.fci.driver.connection import RealRobot
    from station.hw.franka.fci.server.client_services import ArmClientService
    from station.hw.franka.simulated.franka_world import FrankaWorld

_logger = logging.getLogger(__name__)
# Longest period of the loop at which effort controllers with the gains of
# franka_control are stable [s].
_SLOWEST_TORQUE_PERIOD = 0.004
_MODE_NAMES = {float(mode.value): mode.name.lower() for mode in RobotMode}


class FrankaHW(RobotHW):
    """A Franka arm with seven joints: the one at `robot_ip`, or a simulated one.

    Interfaces: JointState and EffortJoint with the measured state, PositionJoint and
    VelocityJoint with the desired state (q_d, dq_d), all under `joint_names`;
    FrankaState, FrankaPoseCartesian and FrankaVelocityCartesian under `<arm_id>_robot`;
    FrankaModel under `<arm_id>_model` and, as the public documentation says, also under
    `<arm_id>_robot`; FrankaServices under `<arm_id>`. If the URDF has a hand,
    GripperServices are under `<arm_id>`, too; the fingers of a simulated hand are in
    EffortJoint and PositionJoint.

    Parameters are those of `franka_parameters`. `init` stores the URDF, with the names
    of this arm, as `robot_description` in the root namespace if there is none yet.

    Args:
        arm: The arm to drive; None connects to the arm at the parameter `robot_ip`, or,
            without that parameter, makes a simulated arm in its own world.

    Attributes:
        commands: The command buffers and their limits; from `init` on.
        cartesian: The buffers and limits of Cartesian commands.
        client_service: Serves a client that may command the arm while no controller
            does; None if clients are not served.
    """

    def __init__(self, arm: RobotArm | None = None) -> None:
        super().__init__()
        self._world: FrankaWorld | None = None
        self._arm = arm
        self._real: RealRobot | None = None
        self.client_service: ArmClientService | None = None
        self._fingers: FingerJoints | None = None

    @override
    def init(self, root_params: Parameters, hw_params: Parameters) -> None:
        """Set the robot up with the parameters that the class names.

        Raises:
            ParameterError: A parameter is missing, unknown or impossible.
            RobotDescriptionError: The URDF cannot be used.
        """
        self._parameters = read_parameters(hw_params)
        self._settings, self._hw_params = read_command_settings(hw_params), hw_params
        arm_id, limits = self._parameters.arm_id, self._parameters.limits
        if self._parameters.remark is not None:
            _logger.warning("%s", self._parameters.remark)
        if self._arm is None:
            self._make_arm(root_params)
        self._mode = self.arm.state.doubles(MODE)
        description = load_arm_description(self._parameters.robot_description, limits)
        # Joints get the name of their arm, so that two arms have different joints.
        description = description.with_prefix(find_prefix(description), f"{arm_id}_")
        if not root_params.has(ROBOT_DESCRIPTION):
            root_params.set(ROBOT_DESCRIPTION, description.xml)
        self.commands = JointCommands(
            self.arm.state, self._parameters.joint_names, self._parameters.limit_mode
        )
        memory = self.commands.memory
        self.cartesian = CartesianCommands(self.arm, arm_id, limits, memory)
        urdf = load_urdf(description)
        self._joints = [urdf.joints[name] for name in joint_names(arm_id)]
        for name in self.commands.add_limits(self._joints, rate_limits_of(limits)):
            _logger.warning("%s has no soft limits in the URDF; none enforced", name)
        state = self.arm.state
        rates = make_joint_rates(limits, state, self.commands)
        self._sender = CommandSender(
            self.arm,
            self._mode,
            _MODE_NAMES,
            self.commands,
            self.cartesian,
            rates,
            make_velocity_curves(limits),
        )
        self._motion = MotionStart(self.arm, self._sender)
        self._guard = ArmGuard(
            arm_id,
            self._parameters.base,
            has_hand=f"{arm_id}_hand" in urdf.links,
            limits=limits,
            state=state,
            sender=self._sender,
        )
        self._reading = ArmReading(
            self.arm,
            self._motion,
            self._sender,
            most_lost=self._parameters.most_lost_packets,
            losses_that_end=MOST_LOST_PACKETS,
        )
        self._add_fingers([f"{arm_id}_finger_joint{number}" for number in (1, 2)], urdf)
        for interface in self.command_interfaces():
            self.register_interface(interface)
        model, services = self.arm.load_model(), FrankaServicesInterface()
        models = model_interface(self.arm, arm_id, model)
        self._services = ArmServices(
            arm_id,
            self.arm,
            self._motion,
            models.handles()[0],
            collision_behavior=self._parameters.collision_behavior,
            limits=self._parameters.service_limits,
            internal_controller=lambda: self._settings.internal_controller,
        )
        services.register_handle(self._services)
        for interface in (state_interface(self.arm, arm_id, model), models, services):
            self.register_interface(interface)
        # Python methods around these calls would cost 4 % of a cycle.
        call_directly(
            self,
            FrankaHW,
            read=self._reading.read,
            write=self._sender.write,
            mode=self._sender.mode_name,
            is_interrupted=self._sender.is_interrupted,
        )

    def _make_arm(self, root_params: Parameters) -> None:
        """Connect to the real arm at `robot_ip`, or simulate one.

        Raises:
            ParameterError: The scene is malformed.
            RobotDescriptionError: The URDF cannot be used.
            FciNetworkError: The real arm does not answer.
            FciProtocolError: The real arm speaks another version.
        """
        # Imported here, because a real and a simulated arm need different packages.
        if self._parameters.robot_ip is not None:
            from station.hw.franka.fci.driver.connection import RealRobot

            self._real = RealRobot(self._parameters)
            self._arm = self._real.arm
        else:
            from station.hw.franka.simulated.franka_world import simulate_one

            parameters = self._parameters
            self.enter_world(simulate_one(parameters, root_params), parameters.arm_id)

    def enter_world(self, world: "FrankaWorld", arm_id: str) -> None:
        """Drive an arm in a simulated world; called before `init`.

        Args:
            world: The world, which several robots may share.
            arm_id: Name of the arm in the world.
        """
        self._world = world
        self._arm = world.arms[arm_id]
        world.add_robot(self)

    def command_interfaces(self) -> Sequence[object]:
        """Return the joint and Cartesian interfaces that controllers may ask for."""
        return [*self.commands.interfaces(), *self.cartesian.interfaces()]

    @property
    def parameters(self) -> FrankaParameters:
        """The parameters that were read in `init`."""
        return self._parameters

    @property
    def arm(self) -> RobotArm:
        """The arm behind this robot.

        Raises:
            RuntimeError: `init` has not made one yet.
        """
        if self._arm is None:
            raise RuntimeError("FrankaHW has no arm before init")
        return self._arm

    @property
    def robot_state(self) -> RobotState:
        """The arm's live state; control thread only."""
        return self.arm.state

    @property
    def is_commanded(self) -> bool:
        """Return whether controllers command the arm, or are about to."""
        return self._sender.is_active

    @property
    def control_mode(self) -> ControlMode:
        """The kinds of command that the running controllers give."""
        return self._motion.mode

    @override
    def components(self) -> Sequence[HardwareComponent]:
        """Return the arm with its hand under the name `arm_id`."""
        (whole,) = super().components()
        return (replace(whole, name=self._parameters.arm_id),)

    @override
    def mode(self) -> str:
        return self._sender.mode_name()

    @override
    def read(self, time: float, period: float) -> None:
        """Update the arm's state, one arm cycle for each elapsed cycle time."""
        self._reading.read(time, period)

    @override
    def write(self, time: float, period: float) -> None:
        """Limit, filter and send the commands of the present mode."""
        self._sender.write(time, period)

    @override
    def joint_limits(self) -> Sequence[JointLimitsReport]:
        return self.commands.limit_reports

    @override
    def clamps(self) -> Sequence[ClampReport]:
        simulation = self.arm.simulation()
        return [*self.commands.clamps(), *(simulation.clamps() if simulation else ())]

    @override
    def check_period(self, period: float) -> None:
        """Refuse a loop faster than the arm; warn of a slow one.

        Args:
            period: Nominal period of the loop [s], > 0.

        Raises:
            HardwareInterfaceError: `period` is shorter than the arm's own cycle.
        """
        is_real, name = self._real is not None, self._parameters.arm_id
        time = self.arm.cycle_time
        self._reading.nominal = arm_cycles_of(period, time, name, is_real=is_real)

    def longest_period(self) -> float:
        """Return the longest time that the world advances in one cycle [s]."""
        parameters, nominal = self._parameters, self._reading.nominal
        longest = (nominal + parameters.most_lost_packets) * self.arm.cycle_time
        return longest if parameters.waits_for_late_loop else inf

    @override
    def check_for_conflict(
        self, controllers: Sequence[ControllerInfo]
    ) -> list[ResourceConflict]:
        conflicts = find_conflicts(controllers, self._parameters.arm_id)
        if self._fingers is not None and not conflicts:
            return self._fingers.find_conflicts(controllers)
        return conflicts

    @override
    def prepare_switch(
        self, start: Sequence[ControllerInfo], stop: Sequence[ControllerInfo]
    ) -> None:
        """Check that the arm can be in the mode that the switch leads to.

        Raises:
            SwitchRefusedError: The arm is not connected, a reading is not finite, the
                mode is not supported, or the arm refuses the motion.
        """
        try:
            settings = read_command_settings(self._hw_params)
        except ParameterError as exc:
            raise SwitchRefusedError(exc.message, remedy=exc.remedy) from exc
        mode, arm_id = self._mode_after(start, stop), self._parameters.arm_id
        # Only controllers that command need a free arm; others may read NaN.
        if self._control_mode_of(start):
            check_free(
                arm_id,
                is_connected=self._services.is_connected(),
                has_client=self.client_service is not None
                and self.client_service.is_moving,
                blindness=self._reading.blindness(),
            )
        if not is_supported(mode):
            raise SwitchRefusedError(
                f"Arm '{arm_id}' cannot be in mode {mode.describe()}.",
                remedy="Run torques with at most one kind of motion.",
                details={"control_mode": mode.describe()},
            )
        if mode and (mode != self.control_mode or self.is_interrupted()):
            # Running controllers continue their commands; new ones begin at rest.
            kept = mode & ~self._control_mode_of(start)
            refusal = self._motion.refusal(mode, settings, kept)
            if refusal is not None:
                raise SwitchRefusedError(
                    f"Arm '{arm_id}' cannot start {mode.describe()}: {refusal}.",
                    remedy="Remove the reason first, or choose other controllers.",
                    details={"control_mode": mode.describe()},
                )
        # Set only now, because a switch that is refused must change nothing.
        self._settings = settings

    @override
    def do_switch(
        self, start: Sequence[ControllerInfo], stop: Sequence[ControllerInfo]
    ) -> None:
        self._motion.has_failed = False
        started = self._control_mode_of(start)
        # If no controller of this arm is involved, its motion continues undisturbed.
        if started or self._control_mode_of(stop):
            self._motion.enter(self._mode_after(start, stop), self._settings, started)
        if self._fingers is not None:
            self._fingers.do_switch(start, stop)

    @override
    def switch_result(self) -> SwitchState:
        if self._motion.has_failed:
            return SwitchState.ERROR
        return SwitchState.ONGOING if self._sender.is_waiting else SwitchState.DONE

    @override
    def switch_result_for(self, controller: ControllerInfo) -> SwitchState:
        return self.switch_result()

    @override
    def is_interrupted(self) -> bool:
        return self._sender.is_interrupted()

    @override
    def interruption_of(self, controller: ControllerInfo) -> str | None:
        # A controller that only reads continues during a reflex.
        if not self._control_mode_of([controller]) or not self.is_interrupted():
            return None
        blindness = self._reading.blindness()
        if blindness is not None:
            return f"arm '{self._parameters.arm_id}' is blind: {blindness}"
        errors = "; ".join(error.description for error in self.arm.errors())
        # The first cause: after a refused command the arm stops, and reports that, too.
        causes = self._sender.refusal or errors or self.arm.failure()
        because = f" ({causes})" if causes else ""
        return f"arm '{self._parameters.arm_id}' went to {self.mode()}{because}"

    @override
    def robot_clock(self) -> RobotClock | None:
        return None if self._real is None else self._real.arm

    @override
    def close(self) -> None:
        if self._real is not None:
            self._real.close()

    @override
    def guards(self) -> Sequence[ArmGuard]:
        return (self._guard,)

    @override
    def address(self) -> str:
        """Return the parameter `robot_ip`; empty for a simulated arm."""
        return self._parameters.robot_ip or ""

    @override
    def simulated_world(self) -> "FrankaWorld | None":
        return self._world

    def begin_anew(self) -> None:
        """Continue in the present mode after a reset of the world."""
        if self._fingers is not None:
            self._fingers.begin_anew()
        self._motion.enter(self.control_mode, self._settings, ControlMode.NONE)

    def joint_limit_warnings(self) -> list[str]:
        """Return one sentence per joint that is close to a position limit."""
        share = self._parameters.joint_limit_warning_threshold
        return joint_limit_warnings(self._joints, self.robot_state.q, share)

    def _add_fingers(self, names: Sequence[str], urdf: Urdf) -> None:
        """Add the hand of the URDF, if it has one, and its finger joints."""
        parameters, interfaces = self._parameters, self.commands.interfaces()
        # The arm has no hand.
        if not all(name in urdf.joints for name in names):
            return
        if self._real is not None:
            self.register_interface(self._real.add_hand(names, interfaces))
        elif self._world is not None:
            gripper = self._world.grippers[parameters.arm_id]
            self._fingers = FingerJoints(gripper, names, parameters.arm_id)
            self._fingers.register(interfaces, in_states=parameters.publishes_fingers)
            self._reading.read_fingers = self._fingers.sensor.read
            self._sender.add_fingers(self._fingers)
            self.register_interface(self._fingers.services)

    def _mode_after(
        self, start: Sequence[ControllerInfo], stop: Sequence[ControllerInfo]
    ) -> ControlMode:
        kept = self.control_mode & ~self._control_mode_of(stop)
        return kept | self._control_mode_of(start)

    def _control_mode_of(self, controllers: Sequence[ControllerInfo]) -> ControlMode:
        return control_mode_of(controllers, self._parameters.arm_id)


def state_interface(
    arm: RobotArm, arm_id: str, model: FrankaModel
) -> FrankaStateInterface:
    """Return the interface with the arm's complete state, `<arm_id>_robot`.

    Args:
        arm: The arm.
        arm_id: Name of the arm.
        model: The arm's model, from which derived fields are computed.
    """
    states = FrankaStateInterface()
    name = f"{arm_id}_robot"
    pose = arm.pose_source(model)
    states.register_handle(FrankaStateHandle(name, arm.state, arm.refresh_state, pose))
    return states


def model_interface(
    arm: RobotArm, arm_id: str, model: FrankaModel
) -> FrankaModelInterface:
    """Return the interface with the arm's model, `<arm_id>_model`.

    Args:
        arm: The arm.
        arm_id: Name of the arm.
        model: The arm's model.

    Source: franka_ros@c11f000 franka_hw/src/franka_hw.cpp, setupFrankaModelInterface;
    differs: the model is `<arm_id>_robot` as well, as the public documentation says.
    """
    models = FrankaModelInterface()
    for name in (f"{arm_id}_model", f"{arm_id}_robot"):
        models.register_handle(FrankaModelHandle(name, model, arm.state))
    return models


def arm_cycles_of(
    period: float, cycle_time: float, arm_id: str, *, is_real: bool = False
) -> int:
    """Return the number of arm cycles in a period; warn of a slow loop.

    Args:
        period: Nominal period of the loop [s], > 0.
        cycle_time: Time from one state of the arm to the next [s], > 0.
        arm_id: Name of the arm.
        is_real: Whether the arm needs a command in each of its cycles.

    Raises:
        HardwareInterfaceError: `period` is shorter than the arm's cycle, or, for a real
            arm, longer.
    """
    # A margin for rounding.
    if period < 0.999 * cycle_time:
        raise HardwareInterfaceError(
            f"The loop runs at {1.0 / period:g} Hz; arm '{arm_id}' takes at most "
            f"{1.0 / cycle_time:g} commands per second.",
            remedy=f"Set station.rate to {1.0 / cycle_time:g} or less.",
            details={"rate": 1.0 / period},
        )
    if period > _SLOWEST_TORQUE_PERIOD:
        _logger.warning(
            "arm '%s' with a loop of %g Hz: torque controllers need small gains "
            "below %g Hz, above all the damping; franka_control's are too large",
            arm_id,
            1.0 / period,
            1.0 / _SLOWEST_TORQUE_PERIOD,
        )
    # Rounded, because 0.001 has no exact binary form.
    cycles = max(1, round(period / cycle_time))
    if is_real and cycles > 1:
        raise HardwareInterfaceError(
            f"The loop runs at {1.0 / period:g} Hz; the real arm '{arm_id}' needs a "
            "command in each of its cycles.",
            remedy=f"Set station.rate to {1.0 / cycle_time:g}.",
            details={"rate": 1.0 / period},
        )
    return cycles


def check_free(
    arm_id: str, *, is_connected: bool, has_client: bool, blindness: str | None
) -> None:
    """Refuse to start controllers of an arm that is not free for them.

    Args:
        arm_id: Name of the arm.
        is_connected: Whether the arm is connected.
        has_client: Whether a client of the Franka Control Interface moves the arm.
        blindness: Name of a reading that is not finite; None if all are finite.

    Raises:
        SwitchRefusedError: The arm is not free.
    """
    if not is_connected:
        raise SwitchRefusedError(
            f"Arm '{arm_id}' is not connected.", remedy="Connect the arm first."
        )
    if has_client:
        raise SwitchRefusedError(
            f"A client of the Franka Control Interface moves arm '{arm_id}'.",
            remedy="Let the client end its motion first.",
        )
    if blindness is not None:
        raise SwitchRefusedError(
            f"Arm '{arm_id}' is blind: {blindness}.",
            remedy="Wait until the sensor reads finite numbers again.",
        )


def joint_limit_warnings(
    joints: Sequence[Joint], q: Sequence[float], threshold: float
) -> list[str]:
    """Return one sentence per joint that is close to a position limit.

    Args:
        joints: The joints of the URDF, n of them.
        q: Their positions [rad], shape (n,).
        threshold: Distance to a limit below which there is a warning [rad], >= 0.

    Source: franka_ros@c11f000 franka_hw/src/franka_hw.cpp, FrankaHW::checkJointLimits.
    """
    warnings = []
    for joint, position in zip(joints, q, strict=True):
        limit = joint.limit
        if limit is None or limit.lower is None or limit.upper is None:
            continue
        distance = min(abs(position - limit.lower), abs(position - limit.upper))
        if distance < threshold:
            warnings.append(
                f"{joint.name} is {degrees(distance):.1f} degrees from a limit"
            )
    return warnings
