"""What happens in an arm before and after every step of its world."""

from station.core.franka.joint_memory import JointMemory
from station.hw.franka.arm import arm_codes as modes
from station.hw.franka.simulated import step_codes as codes
from station.hw.franka.simulated.cartesian_step import CartesianStep
from station.hw.franka.simulated.command_check import CommandCheck
from station.hw.franka.simulated.cycle_log import CycleLog
from station.hw.franka.simulated.desired_motion import DesiredMotion
from station.hw.franka.simulated.joint_motors import JointMotors
from station.hw.franka.simulated.joint_watch import JointWatch
from station.hw.mujoco.simulator_memory import SimulatorMemory
from station.hw.mujoco.world_step import Preparation
from station.memory.doubles import Doubles, Storage
from station.memory.vectors import any_of, are_finite, copy_into

# As C numbers, by the .pxd.
_IDLE = modes.IDLE
_MOVE = modes.MOVE
_GUIDING = modes.GUIDING
_RECOVERY = modes.RECOVERY
_POSITIONS = codes.POSITIONS
_VELOCITIES = codes.VELOCITIES
_CARTESIAN = codes.CARTESIAN
_CONTACT = codes.CONTACT
_UNUSUAL = codes.UNUSUAL


class ArmStep(Preparation):
    """The usual cycle of an arm; what is unusual is left to whoever calls.

    Args:
        memory: State and commands of the joints.
        mode: The mode of the arm, one number.
        motion: The desired motion.
        cartesian: Follows poses and twists.
        motors: Controls and torque sensors.
        check: Compares commanded motions and torques with their limits.
        watch: Looks at the readings.
        log: The last cycles.
        simulator: The simulator's memory of the joints.

    Attributes:
        generator: What the motion commands.
        wants_torques: Whether the motion commands torques.
        torques_act: Whether the motors follow the commanded torques.
        has_curves: Whether limits depend on the position: commands and readings are
            always looked at closer.
        has_load: Whether a load is configured.
        has_faults: Whether a simulated fault acts.
        is_cartesian: Whether the Cartesian impedance acts.
        is_following: Whether an internal controller follows the desired motion.
        is_fresh: Whether a command has arrived since the last cycle.
        is_begun: Whether a command of this motion has been followed.
        is_lossy: Whether commands were lost in the last cycles.
        cycle: Number of cycles with or without a command since the motion began.
        time: Time of the arm at the last state [s].
    """

    def __init__(
        self,
        memory: JointMemory,
        mode: Doubles,
        *,
        motion: DesiredMotion,
        cartesian: CartesianStep,
        motors: JointMotors,
        check: CommandCheck,
        watch: JointWatch,
        log: CycleLog,
        simulator: SimulatorMemory,
    ) -> None:
        self.memory = memory
        self.size = memory.size
        self.mode = mode
        self.motion = motion
        self.cartesian = cartesian
        self.motors = motors
        self.check = check
        self.watch = watch
        self.log = log
        self.simulator = simulator
        self.generator = codes.NO_MOTION
        self.wants_torques = False
        self.torques_act = False
        self.has_curves = False
        self.has_load = False
        self.has_faults = False
        self.is_cartesian = False
        self.is_following = False
        self.is_fresh = False
        self.is_begun = False
        self.is_lossy = False
        self.cycle = 0
        self.time = 0.0

    def receive_end_effector(self, values: Doubles, size: int) -> bool:
        """Take a pose, 16 numbers, or a twist [m/s, rad/s], 6; see `receive`.

        Args:
            values: The command.
            size: How many numbers it must have.
        """
        if not self.receive(values, size, self.cartesian.command):
            return False
        self.cartesian.size = size
        return True

    def receive(self, values: Storage, size: int, place: Storage) -> bool:
        """Take a command for the next cycle.

        Args:
            values: The command.
            size: How many numbers it must have.
            place: Where it goes, shape (size,) or longer: torques [Nm], positions [rad]
                or velocities [rad/s] of the joints, or what the end effector is to do.

        Returns:
            Whether it certainly is that many finite numbers; if not, nothing has
            changed.
        """
        if len(values) != size:
            return False
        if not are_finite(values, size):
            return False
        copy_into(place, 0, values, size)
        log = self.log
        log.command, log.command_size = place, size
        self.is_fresh = True
        return True

    def before(self) -> bool:
        """Take the command, advance the desired motion, and set the motors' controls.

        Returns:
            Whether that was done. If not, nothing has changed.
        """
        if self.has_load or self.has_faults or self.is_cartesian:
            return False
        if self.wants_torques != self.torques_act:
            return False
        mode = self.mode[0]
        moves = mode == _MOVE
        if not moves and (mode == _GUIDING or mode == _RECOVERY):
            return False
        if moves and self.is_fresh:
            if not self.take_command():
                return False
        elif moves and self.is_begun:
            return False  # a lost command
        else:
            self.motion.hold()
        if self.torques_act:
            self.motors.apply_torques()
        else:
            self.motors.apply_impedance(moves)
        return True

    def take_command(self) -> bool:
        """Follow a command that has arrived; return False if it must be looked at."""
        generator, check, memory = self.generator, self.check, self.memory
        if self.is_lossy:
            return False
        if self.torques_act and not check.admit_torques():
            return False
        if generator == _POSITIONS:
            # The first position must be close to the present one.
            if not self.is_begun or self.has_curves or not check.admit_positions():
                return False
            self.motion.follow_positions()
        elif generator == _VELOCITIES:
            if self.has_curves or not check.admit_velocities():
                return False
            self.motion.follow_velocities()
        elif generator == _CARTESIAN:
            if not self.is_begun or self.has_curves or not self.cartesian.follow():
                return False
            self.motion.follow_positions()
        else:
            self.motion.hold()
        if self.torques_act:
            # For the check of the next ones.
            copy_into(memory.sent, 0, memory.torques, self.size)
        self.cycle += 1
        self.is_fresh = False
        self.is_begun = True
        self.log.note(self.time)
        return True

    def after(self, time: float) -> int:
        """Read the joints after a step, and look at the readings.

        Args:
            time: Time of the arm [s].

        Returns:
            0 when nothing is unusual, otherwise a sum of `CONTACT` and `UNUSUAL`.
        """
        self.time = time
        self.motors.sense()
        result, mode = 0, self.mode[0]
        if any_of(self.simulator.constraint_forces, self.size):
            result = _CONTACT
        supervised = mode == _MOVE or mode == _IDLE or mode == _RECOVERY
        if supervised:
            is_quiet = self.watch.is_quiet(self.is_following)
            if self.has_curves or not is_quiet:
                result += _UNUSUAL
        return result
