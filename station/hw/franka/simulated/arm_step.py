"""The cycle of a simulated arm: its commands, and its state after a step of its world.

Source: Franka Control Interface documentation, on lost packets.
"""

from collections import deque
from collections.abc import Sequence
from math import isfinite
from typing import TYPE_CHECKING, NoReturn

from station.core.errors import InvalidCommandError
from station.core.franka.franka_robot_state import MODE, RobotState
from station.core.franka.joint_memory import JointMemory
from station.hw.franka.arm import receiver as codes
from station.hw.franka.arm.receiver import Receiver
from station.hw.franka.arm.robot_arm import MOST_LOST_PACKETS
from station.hw.franka.simulated.cartesian_step import CartesianStep
from station.hw.franka.simulated.desired_motion import DesiredMotion
from station.hw.franka.simulated.friction_and_observer import (
    LOST,
    TOUCHED,
    WEAK,
    FrictionAndObserver,
)
from station.hw.franka.simulated.joint_motors import JointMotors
from station.hw.franka.simulated.joint_watch import JointWatch
from station.hw.franka.simulated.motion_check import MotionCheck
from station.hw.franka.simulated.planned_motion import PlannedMotion
from station.hw.franka.simulated.violations import JOINT_POSITION, LOST_COMMANDS
from station.hw.mujoco.world_step import Preparation, WorldStep
from station.memory.doubles import Doubles, Storage, doubles, own_zeros, put, zeros
from station.memory.vectors import any_of, are_finite, copy_into

if TYPE_CHECKING:
    from station.hw.franka.simulated.arm_modes import ArmModes
    from station.hw.franka.simulated.arm_motors import ArmMotors
    from station.hw.franka.simulated.franka_dynamics import ArmLoad
    from station.hw.franka.simulated.sensor_faults import SensorFaults

LONGEST_SETTLING = 500
"""Number of arm cycles after which the arm counts as settled although it trembles."""
CONTACT = 1
"""Result of `read_joints`: a contact or a mechanical stop acts on a joint."""
VIOLATION = 2
"""Result of `read_joints`: a reading violates a limit."""
# Number of cycles over which the success rate of commands is computed.
# Source: libfranka@0.9.2 robot_state.h, control_command_success_rate.
_WINDOW = 100
# Joint damping while a person guides the arm [Nm s/rad].
_GUIDING_DAMPING = (10.0, 10.0, 10.0, 10.0, 1.0, 1.0, 1.0)
# The .pxd declares these as C numbers.
_IDLE = codes.IDLE
_MOVE = codes.MOVE
_GUIDING = codes.GUIDING
_RECOVERY = codes.RECOVERY
_NO_MOTION = codes.NO_MOTION
_POSITIONS = codes.POSITIONS
_VELOCITIES = codes.VELOCITIES
_CARTESIAN = codes.CARTESIAN
_POSE = 16
_CONTACT = CONTACT
_VIOLATION = VIOLATION
_TOUCHED = TOUCHED
_ASKS = WEAK | LOST

# As many as libfranka keeps by default.
CYCLES_KEPT = 50
"""Number of cycles in the log."""
LONGEST_COMMAND = 16
"""Largest number of values in a command."""


class CycleLog:
    """Keeps time, state and command of the last cycles. No allocation.

    Args:
        states: State of the joints: k quantities side by side, shape (k n,).
        size: Number n of joints.

    Attributes:
        count: Number of cycles noted since the last `clear`.
        command: Memory that begins with the last command, of at most `LONGEST_COMMAND`
            doubles.
        command_size: Number of values in the last command.
    """

    def __init__(self, states: Doubles, size: int) -> None:
        self.states = states
        self.size = size
        self.capacity = CYCLES_KEPT
        self.command = own_zeros(LONGEST_COMMAND)
        self.command_size = 0
        self.width = 1 + len(states)
        self.rows = zeros(CYCLES_KEPT * self.width)
        self.commands = own_zeros(CYCLES_KEPT * LONGEST_COMMAND)
        self.command_sizes = own_zeros(CYCLES_KEPT)
        self.count = 0

    def clear(self) -> None:
        """Forget all cycles."""
        self.count = 0

    def note(self, time: float) -> None:
        """Add this cycle.

        Args:
            time: Time of the arm [s].
        """
        place = self.count % self.capacity
        start = place * self.width
        self.rows[start] = time
        copy_into(self.rows, start + 1, self.states, self.width - 1)
        command = self.command
        copy_into(self.commands, place * LONGEST_COMMAND, command, len(command))
        self.command_sizes[place] = self.command_size
        self.count += 1

    def cycles(self) -> list[tuple[float, list[list[float]], list[float]]]:
        """Return time, the k quantities and the command, oldest cycle first."""
        found = []
        for number in range(max(0, self.count - CYCLES_KEPT), self.count):
            place = number % CYCLES_KEPT
            start = place * self.width
            row = [self.rows[i] for i in range(start, start + self.width)]
            firsts = range(1, self.width, self.size)
            state = [row[first : first + self.size] for first in firsts]
            first = place * LONGEST_COMMAND
            last = first + int(self.command_sizes[place])
            command = [self.commands[i] for i in range(first, last)]
            found.append((row[0], state, command))
        return found


class PacketLosses:
    """Counts the cycles of a motion in which no command arrived.

    No cycle is counted before the first loss, or when the last loss is `_WINDOW` cycles
    ago: the share of commands that arrived is then 1.

    Attributes:
        in_a_row: Number of cycles since the last command.
    """

    def __init__(self) -> None:
        self.in_a_row = 0
        self._cycle = 0
        self._recent: deque[int] = deque()

    def count(self, *, arrived: bool) -> float:
        """Count a cycle.

        Args:
            arrived: Whether a command has arrived in this cycle.

        Returns:
            Share of the last cycles that brought a command, 0 to 1.
        """
        self._cycle += 1
        recent = self._recent
        if arrived:
            self.in_a_row = 0
        else:
            self.in_a_row += 1
            recent.append(self._cycle)
        while recent and recent[0] <= self._cycle - _WINDOW:
            recent.popleft()
        return 1.0 - len(recent) / _WINDOW


class ArmStep(Preparation):
    """Follows the client's commands, sets the motors, and reads the joints.

    A cycle without a command counts as a lost packet: the motion continues with
    constant acceleration, and torques keep their values. Control thread only.

    Args:
        memory: State and commands of the joints.
        state: The arm's state.
        motion: The desired motion.
        cartesian: Follows poses and twists.
        motors: Controls and torque sensors.
        actuators: The internal controllers.
        load: The configured load.
        faults: The simulated faults.
        check: Compares commanded motions and torques with their limits.
        watch: Compares the readings with their limits.
        log: The last cycles.
        world: The world's steps.

    Attributes:
        modes: The modes of the arm; set before the first step.
        observer: Disturbs the readings; None for an ideal arm; set before the first
            step.
        generator: Kind of the commands of the motion.
        wants_torques: Whether the motion commands torques.
        has_load: Whether a load is configured.
        has_faults: Whether a simulated fault acts.
        is_following: Whether an internal controller follows the desired motion.
        is_quiet: Whether nothing touches the arm; if false, every cycle is supervised.
        is_fresh: Whether a command has arrived since the last cycle.
        is_begun: Whether the arm has followed a command of this motion.
        is_lossy: Whether commands were lost in the last cycles.
        plan: Source of the arm's own commands; None if a client commands it.
        seen: Number of the world's step after which the joints were read last.
    """

    def __init__(
        self,
        memory: JointMemory,
        state: RobotState,
        *,
        motion: DesiredMotion,
        cartesian: CartesianStep,
        motors: JointMotors,
        actuators: "ArmMotors",
        load: "ArmLoad",
        faults: "SensorFaults",
        check: MotionCheck,
        watch: JointWatch,
        log: CycleLog,
        world: WorldStep,
    ) -> None:
        self.memory = memory
        self.state = state
        self.mode = state.doubles(MODE)
        self.motion = motion
        self.cartesian = cartesian
        self.motors = motors
        self.actuators = actuators
        self.load = load
        self.faults = faults
        self.check = check
        self.watch = watch
        self.log = log
        self.world = world
        self.steps = self.seen = world.count
        self.modes: ArmModes
        self.observer: FrictionAndObserver | None = None
        self.wants_torques = False
        self.has_load = False
        self.has_faults = False
        self.is_following = False
        self.is_quiet = True
        self.settling = 0
        self.begin_motion(codes.NO_MOTION)

    def begin_motion(self, generator: int) -> None:
        """Wait for the first command of a motion.

        Args:
            generator: The kind of motion that is commanded, see `receiver`.
        """
        self.generator = generator
        self.is_fresh = self.is_begun = self.is_lossy = False
        self.settling = 0
        self.losses = PacketLosses()
        put(self.memory.torques, [0.0] * self.memory.size)
        put(self.memory.sent, [0.0] * self.memory.size)
        self.log.command_size = 0
        self.plan: PlannedMotion | None = None
        self.cartesian.has_elbow = False
        self.cartesian.begin_motion()

    def command_torques(self, tau: Storage) -> None:
        """Take torques [Nm], shape (7,), for the next cycle.

        Raises:
            InvalidCommandError: The command is not 7 finite numbers.
        """
        if not self.receive(_as_doubles(tau), self.memory.size, self.memory.torques):
            _refuse("joint torques", self.memory.size, tau)

    def command_joints(self, values: Storage) -> None:
        """Take positions [rad] or velocities [rad/s], shape (7,), for the next cycle.

        Raises:
            InvalidCommandError: The command is not 7 finite numbers.
        """
        if not self.receive(_as_doubles(values), self.memory.size, self.memory.target):
            _refuse("joint commands", self.memory.size, values)

    def plan_joints(self, q: Storage, fastest: Sequence[float]) -> None:
        """Plan the motion to positions, from the next cycle on.

        Args:
            q: Target positions [rad], shape (7,).
            fastest: Largest velocities, > 0 [rad/s], shape (7,).

        Raises:
            InvalidCommandError: The target is not 7 finite numbers.
        """
        target = _as_doubles(q)
        if len(target) != self.memory.size or not are_finite(target, self.memory.size):
            _refuse("joint positions", self.memory.size, q)
        violations = self.check.violations
        violations.count = 0
        if self.check.check_target(target):
            self.modes.raise_errors(violations.errors())
            return
        if self.plan is None:
            self.plan = PlannedMotion(self.memory, self.check.limits, self.check.period)
        self.plan.aim(target, fastest)

    def command_cartesian(
        self, values: Storage, elbow: Sequence[float] | None, size: int
    ) -> None:
        """Take a pose or a twist for the next cycle.

        Args:
            values: The pose O_T_EE or the twist O_dP_EE.
            elbow: Position of joint 3 [rad] and sign of joint 4, or None.
            size: Count of numbers that `values` must have.

        Raises:
            InvalidCommandError: `values` are not `size` finite numbers, or the elbow
                is malformed.
        """
        # Checked first, so that a malformed elbow leaves the last command unchanged.
        if elbow is not None:
            _check_elbow(elbow)
        if not self.receive_end_effector(_as_doubles(values), size):
            _refuse("a Cartesian command", size, values)
        if elbow is not None:
            put(self.cartesian.elbow_command, elbow)
            self.cartesian.has_elbow = True

    def receive_end_effector(self, values: Storage, size: int) -> bool:
        """Take a pose, 16 numbers, or a twist, 6, without an elbow; see `receive`.

        Args:
            values: The command.
            size: Count of numbers that the command must have.
        """
        if not self.receive(values, size, self.cartesian.command):
            return False
        self.cartesian.size = size
        self.cartesian.has_elbow = False
        return True

    def receive(self, values: Storage, size: int, place: Storage) -> bool:
        """Take a command for the next cycle.

        Args:
            values: The command.
            size: Count of numbers that the command must have.
            place: Receives the command, shape (>= size,): torques [Nm], positions [rad]
                or velocities [rad/s] of the joints, or a command of the end effector.

        Returns:
            Whether the command is known to be that many finite numbers; if not, nothing
            has changed.
        """
        # A NaN would stay in the desired motion, because every cycle starts from the
        # cycle before.
        if len(values) != size or not are_finite(values, size):
            return False
        copy_into(place, 0, values, size)
        self.log.command, self.log.command_size = place, size
        self.is_fresh = True
        return True

    def prepare_step(self) -> None:
        """Follow the command or hold, and set the motors' controls."""
        mode, motors = self.mode[0], self.motors
        if self.wants_torques and not motors.torques_act:
            self.wait_for_rest()
        # Before any return, because an arm also carries its load while it is guided or
        # recovers.
        if self.has_load:
            self.actuators.carry(self.load.weight(list(self.memory.positions)))
        if self.has_faults:
            self.faults.count_step()
        if mode == _GUIDING:
            self.apply_guiding()
            return
        if mode == _RECOVERY:
            self.modes.advance_recovery()
        elif mode != _MOVE:
            self.motion.hold()
        # Torques act only on a settled arm; earlier commands are ignored.
        elif self.wants_torques != motors.torques_act:
            self.ignore_command()
        elif self.follow_command():
            self.modes.raise_errors(self.check.violations.errors())
            self.motion.hold()
        # An error, or the end of a recovery, may have changed the mode.
        if motors.torques_act:
            motors.apply_torques()
        elif motors.is_cartesian:
            self.actuators.apply_cartesian_impedance()
        else:
            motors.apply_impedance(self.mode[0] == _MOVE)
        if self.has_faults:
            self.faults.finish_cycle()
            self.has_faults = self.faults.act

    def wait_for_rest(self) -> None:
        """Let commanded torques act once the arm has come to rest."""
        if self.motion.is_at_rest():
            self.settling += 1
            # An arm that trembles in a contact is never still, and its client would
            # wait for ever.
            if self.modes.is_still() or self.settling > LONGEST_SETTLING:
                self.actuators.engage_torques()

    def apply_guiding(self) -> None:
        """Let a person move the arm against some damping."""
        memory = self.memory
        # q_d follows the hand; otherwise the arm would jump back when it is released.
        self.motion.seed(memory.positions, memory.dtheta)
        pairs = zip(_GUIDING_DAMPING, memory.dtheta, strict=True)
        self.actuators.apply_torques([-damping * rate for damping, rate in pairs])

    def ignore_command(self) -> None:
        """Discard this cycle's command and slow down to rest."""
        self.is_fresh = False
        self.motion.hold()
        # Braking moves only the joints; the next pose starts from where they are then.
        if self.generator == _CARTESIAN:
            self.cartesian.begin_motion()

    def follow_command(self) -> int:
        """Advance the desired motion by a cycle; return the number of violations."""
        memory, violations = self.memory, self.check.violations
        arrived = self.is_fresh
        if self.has_faults and self.faults.loses_packet():
            arrived = False
        if self.plan is not None:
            arrived = self.receive(self.plan.advance(), memory.size, memory.target)
        self.is_fresh = False
        violations.count = 0
        # Losses count from the first command on: a client may take time to begin.
        if not arrived and not self.is_begun:
            self.motion.hold()
            return 0
        # Without recent losses there is nothing to count.
        was_lossy = self.is_lossy
        if not arrived or was_lossy:
            self.count_losses(arrived)
        if self.motors.torques_act and violations.count == 0:
            if arrived:
                self.check.check_torques()
                copy_into(memory.sent, 0, memory.torques, memory.size)
            else:
                # A lost packet: the motors keep the torques that arrived last.
                copy_into(memory.torques, 0, memory.sent, memory.size)
        if violations.count:
            return violations.count
        if self.generator == _NO_MOTION:
            self.motion.hold()
        else:
            self.advance_motion(arrived, was_lossy)
        self.is_begun = True
        if violations.count == 0:
            self.log.note(self.seen * self.check.period)
        return violations.count

    def advance_motion(self, arrived: bool, was_lossy: bool) -> None:  # noqa: FBT001
        """Advance the desired motion if the command is within the limits.

        Args:
            arrived: Whether a command has arrived in this cycle.
            was_lossy: Whether commands were lost in the last cycles.
        """
        check = self.check
        violations = check.violations
        if self.generator == _CARTESIAN:
            if arrived:
                # Joints that settle need no computation. This saves time only for an
                # arm at rest without any of these.
                may_settle = (
                    self.is_begun
                    and not was_lossy
                    and not self.has_load
                    and not self.has_faults
                    and not check.curves.size
                    and not self.motors.is_cartesian
                    and not self.cartesian.has_elbow
                )
                self.cartesian.follow_command(not self.is_begun, may_settle)
            else:
                self.cartesian.extrapolate()
            if violations.count == 0:
                self.motion.follow_positions()
        elif not arrived:
            self.motion.extrapolate()
        elif self.generator == _POSITIONS:
            # The first position must be close to the present one.
            if self.is_begun or check.check_start() == 0:
                check.check_positions(JOINT_POSITION)
            if violations.count == 0:
                self.motion.follow_positions()
        elif check.check_velocities() == 0:
            self.motion.follow_velocities()

    def count_losses(self, arrived: bool) -> None:  # noqa: FBT001 - a C function
        """Count cycles with and without a command; too many losses are a violation.

        Args:
            arrived: Whether a command has arrived in this cycle.
        """
        share = self.losses.count(arrived=arrived)
        self.state.control_command_success_rate = share
        self.is_lossy = share < 1.0
        lost = self.losses.in_a_row
        if lost >= MOST_LOST_PACKETS:
            most = MOST_LOST_PACKETS - 1
            self.check.violations.add(LOST_COMMANDS, 0, float(lost), float(most))

    def read_state(self) -> RobotState:
        """Advance the world unless another arm has; return the arm's state."""
        world = self.world
        self.steps += 1
        while world.count < self.steps:
            world.make_step()
        steps = world.count
        # After a late cycle another arm has advanced the world: this state was read
        # already.
        if self.seen >= steps:
            return self.state
        self.seen = steps
        found = self.read_joints()
        observer = self.observer
        if observer is not None:
            if self.has_load:
                self.expect_load()
            observed = observer.sense()
            if observed & _TOUCHED:
                self.is_quiet = False
            if observed & _ASKS:
                self.modes.react_to_observer(observed)
        # The rest is plain Python, and is skipped while nothing can have changed.
        if (
            found
            or world.is_pushed
            or world.stands_still
            or self.has_load
            or not self.is_quiet
            or self.watch.is_alert
        ):
            self.modes.supervise(found)
        return self.state

    def read_joints(self) -> int:
        """Read the joints after a step, and compare the readings with their limits.

        Returns:
            A sum of `CONTACT` and `VIOLATION`; 0 if neither applies.
        """
        # Before the joints are read, because the state still has the velocities of the
        # last step.
        if self.has_load:
            velocities = self.motors.simulator.velocities
            self.load.note_motion(self.memory.dtheta, velocities, self.check.period)
        self.motors.sense()
        mode = self.mode[0]
        contact = violation = 0
        motors = self.motors
        if any_of(motors.simulator.constraint_forces, motors.size):
            contact = _CONTACT
        # In the other modes there is an error, or a person holds the arm: no motion
        # runs that another error could end.
        is_supervised = mode == _MOVE or mode == _IDLE or mode == _RECOVERY
        if is_supervised and self.watch.check_readings(self.is_following, True):  # noqa: FBT003 - C
            violation = _VIOLATION
        self.state.time = self.seen * self.check.period
        if self.has_faults:
            self.faults.disturb(self.state)
        return contact | violation

    def expect_load(self) -> None:
        """Let the observer expect the torques of the load."""
        if self.observer is not None:
            put(self.observer.expected, self.load_torques() or [0.0] * self.memory.size)

    def load_torques(self) -> list[float] | None:
        """Return the torques for the configured load [Nm], (7,); None without a load.

        The accelerations are differences of the last two measured velocities.
        """
        if not self.has_load:
            return None
        return self.load.torques(list(self.memory.positions), list(self.memory.dtheta))

    def read_rest(self) -> None:
        """Read the pose to which the world was set, with all velocities zero."""
        state = self.state
        state.dq = state.dtheta = [0.0] * self.memory.size
        state.q = state.theta = list(self.motors.simulator.positions)
        put(self.memory.positions, state.q)


class StepReceiver(Receiver):
    """Takes commands of the motion that runs, if they are finite numbers.

    Args:
        step: The arm's cycle.
    """

    def __init__(self, step: ArmStep) -> None:
        self.step = step

    def receive(self, values: Storage, kind: int) -> bool:
        """Take a command if possible; return whether it was taken."""
        step = self.step
        if kind == _NO_MOTION:
            return step.wants_torques and step.receive(
                values, step.memory.size, step.memory.torques
            )
        if kind != step.generator:
            return False
        if kind == _CARTESIAN:
            return step.receive_end_effector(values, _POSE)
        return step.receive(values, step.memory.size, step.memory.target)

    def rests_at_pose(self) -> bool:
        """Return whether the end effector has come to rest at the last pose."""
        return self.step.cartesian.is_settled


def _as_doubles(values: Storage) -> Doubles:
    return doubles(values) if isinstance(values, (list, tuple)) else values


def _check_elbow(elbow: Sequence[float]) -> None:
    if len(elbow) != 2 or not isfinite(elbow[0]) or abs(elbow[1]) != 1.0:
        raise InvalidCommandError(
            f"An elbow of {elbow} is not possible.",
            remedy="Give the position of joint 3 and a sign of +1 or -1.",
        )


def _refuse(what: str, size: int, values: Storage) -> NoReturn:
    raise InvalidCommandError(
        f"{what} must be {size} finite numbers, not {[*values]}",
        remedy="Correct the controller that commands them.",
    )
