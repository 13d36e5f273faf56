"""Set the motors of a simulated arm before every step of its world."""

from station.core.franka.franka_robot_state import RobotMode
from station.hw.franka.arm.robot_arm import ControllerMode
from station.hw.franka.simulated.arm_modes import LONGEST_SETTLING, ArmModes
from station.hw.franka.simulated.arm_parts import ArmParts

# Joint damping while a person guides the arm [Nm s/rad].
_GUIDING_DAMPING = (10.0, 10.0, 10.0, 10.0, 1.0, 1.0, 1.0)


class ArmDrive:
    """Advances the desired motion of one arm and sets its motors. Control thread only.

    Args:
        parts: The parts of the arm.
        modes: The modes of the arm.
    """

    def __init__(self, parts: ArmParts, modes: ArmModes) -> None:
        self._state = parts.state
        self._modes = modes
        self._motion = parts.cycle.motion
        self._positions = parts.cycle.memory.positions
        self._step = parts.cycle.step
        self._follower = parts.follower
        self._motors = parts.motors
        self._load = parts.load
        self._faults = parts.faults
        self._settling = 0

    def is_at_rest(self) -> bool:
        """Return whether neither the arm nor its desired motion moves."""
        return self._motion.is_at_rest() and self._modes.is_still()

    def begin_motion(self) -> None:
        """Wait for the arm to settle before torques act."""
        self._settling = 0

    def attend(self) -> None:
        """Do what `ArmStep.before` does in a cycle that is not a usual one."""
        state, motors = self._state, self._motors
        wants_torques = self._modes.controller is ControllerMode.EXTERNAL_CONTROLLER
        if wants_torques and not motors.torques_act and self._motion.is_at_rest():
            self._let_torques_act_when_settled()
        if self._load.load.mass:
            motors.carry(self._load.weight(list(self._positions)))
        self._faults.before_step()
        mode = state.robot_mode
        if mode is RobotMode.GUIDING:
            self._motion.seed(self._positions, state.dtheta)
            motors.apply_torques([
                -d * dq for d, dq in zip(_GUIDING_DAMPING, state.dtheta, strict=True)
            ])
            return
        if mode is RobotMode.AUTOMATIC_ERROR_RECOVERY:
            if not self._modes.advance_return():
                self._motion.hold()
            self._modes.finish_recovery()
        elif mode is not RobotMode.MOVE:
            self._motion.hold()
        elif wants_torques is not motors.torques_act:
            self._follower.ignore()
        else:
            self._follow()
        motors.apply()
        self._faults.finish_cycle()
        self._step.has_faults = self._faults.act

    def _follow(self) -> None:
        """Advance the desired motion with the client's command; abort it on errors."""
        errors = self._follower.advance(
            torques_act=self._motors.torques_act,
            is_lossy=self._faults.loses_packet(),
        )
        if errors:
            self._modes.raise_errors(errors)
            self._motion.hold()

    def _let_torques_act_when_settled(self) -> None:
        self._settling += 1
        if self._modes.is_still() or self._settling > LONGEST_SETTLING:
            self._motors.engage_torques()
