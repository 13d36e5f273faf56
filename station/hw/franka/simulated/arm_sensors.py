"""The joint sensors of a simulated arm, with the effect of a configured load."""

from station.core.franka.franka_robot_state import RobotState
from station.hw.franka.simulated.arm_load import ArmLoad
from station.hw.franka.simulated.arm_motors import ArmMotors
from station.hw.franka.simulated.sensor_faults import SensorFaults
from station.hw.mujoco.world_joints import WorldJoints

_ZEROS = [0.0] * 7


class ArmSensors:
    """Reads the joints of one arm into its state. Control thread only.

    Args:
        joints: The arm's joints in the world.
        state: The arm's state; time, measured positions, velocities and torques are
            written.
        motors: Computes the measured torques.
        load: The configured load.
        faults: The faults that change readings.
        period: Duration of a cycle [s], > 0.
    """

    def __init__(
        self,
        joints: WorldJoints,
        state: RobotState,
        *,
        motors: ArmMotors,
        load: ArmLoad,
        faults: SensorFaults,
        period: float,
    ) -> None:
        self._joints = joints
        self._state = state
        self._motors = motors
        self._load = load
        self._faults = faults
        self._period = period
        self._ddq = _ZEROS

    def read(self, time: float) -> None:
        """Bring the measured fields of the state up to date.

        Args:
            time: Time of the arm [s].
        """
        state, joints = self._state, self._joints
        dq = joints.read_velocities()
        self._motors.read_torques(dq, state.dtheta, self._period)
        if self._load.load.mass:
            self._ddq = [
                (new - old) / self._period
                for new, old in zip(dq, state.dtheta, strict=True)
            ]
        state.q[:] = state.theta[:] = joints.read_positions()
        state.dq[:] = state.dtheta[:] = dq
        state.time = time
        self._faults.disturb(state)

    def rest(self) -> None:
        """Read the pose to which the world was set, with all velocities zero."""
        state = self._state
        state.dq[:] = state.dtheta[:] = _ZEROS
        state.q[:] = state.theta[:] = self._joints.read_positions()

    def load_torques(self) -> list[float] | None:
        """Return the torques for the configured load [Nm], (7,); None without a load.

        The accelerations are differences of the last two measured velocities.
        """
        if not self._load.load.mass:
            return None
        state = self._state
        return self._load.torques(state.theta, state.dtheta, self._ddq)
