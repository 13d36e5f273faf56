"""The joint sensors of a simulated arm, with the effect of a configured load."""

from station.core.franka.franka_robot_state import RobotState
from station.hw.franka.simulated.arm_step import ArmStep
from station.hw.franka.simulated.franka_dynamics import ArmLoad
from station.hw.franka.simulated.sensor_faults import SensorFaults
from station.hw.mujoco.world_joints import WorldJoints
from station.memory.doubles import Doubles, put

_ZEROS = [0.0] * 7


class ArmSensors:
    """Reads the joints of one arm into its state. Control thread only.

    Args:
        joints: The arm's joints in the world.
        state: The arm's state; time, measured positions, velocities and torques are
            written.
        positions: Positions of the joints as they are [rad], shape (7,); written.
        step: Reads the joints.
        load: The configured load.
        faults: The faults that change readings.
        period: Duration of a cycle [s], > 0.
    """

    def __init__(
        self,
        joints: WorldJoints,
        state: RobotState,
        *,
        positions: Doubles,
        step: ArmStep,
        load: ArmLoad,
        faults: SensorFaults,
        period: float,
    ) -> None:
        self._joints = joints
        self._state = state
        self._positions = positions
        self._step = step
        self._load = load
        self._faults = faults
        self._period = period
        self._ddq = _ZEROS

    def read(self, time: float) -> int:
        """Bring the measured fields of the state up to date.

        Args:
            time: Time of the arm [s].

        Returns:
            What `ArmStep.read_joints` has found.
        """
        step, state = self._step, self._state
        # Before the joints are read: the state still has the velocities of the last
        # step.
        if step.has_load:
            self._ddq = [
                (new - old) / self._period
                for new, old in zip(
                    self._joints.read_velocities(), state.dtheta, strict=True
                )
            ]
        found = step.read_joints(time)
        state.time = time
        if step.has_faults:
            self._faults.disturb(state)
        return found

    def rest(self) -> None:
        """Read the pose to which the world was set, with all velocities zero."""
        state = self._state
        state.dq = state.dtheta = _ZEROS
        state.q = state.theta = self._joints.read_positions()
        put(self._positions, state.q)

    def load_torques(self) -> list[float] | None:
        """Return the torques for the configured load [Nm], (7,); None without a load.

        The accelerations are differences of the last two measured velocities.
        """
        if not self._step.has_load:
            return None
        state = self._state
        return self._load.torques(list(self._positions), state.dtheta, self._ddq)
