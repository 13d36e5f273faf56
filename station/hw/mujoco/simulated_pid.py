"""PID controllers inside a simulated robot, for the joints that have gains."""

from collections.abc import Mapping

from station.core.description.urdf import Joint, JointType
from station.core.errors import ParameterError
from station.core.numerics.joint_errors import (
    shortest_angular_distance,
    shortest_angular_distance_with_limits,
)
from station.core.numerics.pid import Pid
from station.core.parameters import Parameters


class SimulatedPid:
    """Turns a position or velocity command of one joint into an effort.

    Args:
        joint: The joint.
        pid: The PID controller of the joint.

    Source: gazebo_ros_control@2.9.2 default_robot_hw_sim.cpp,
    DefaultRobotHWSim::writeSim.
    """

    def __init__(self, joint: Joint, pid: Pid) -> None:
        self._type = joint.type
        self._limit = joint.limit
        self._pid = pid

    def reset(self) -> None:
        """Reset the PID controller: its last error and its integral are 0 again."""
        self._pid.reset()

    def effort_for_position(
        self, command: float, position: float, period: float
    ) -> float:
        """Return the effort [Nm or N] for a position command [rad or m].

        Args:
            command: Desired position [rad or m].
            position: Measured position [rad or m].
            period: Time since the last cycle [s], > 0.
        """
        return self._saturate(
            self._pid.compute_command(self._error(command, position), period)
        )

    def effort_for_velocity(
        self, command: float, velocity: float, period: float
    ) -> float:
        """Return the effort [Nm or N] for a velocity command [rad/s or m/s].

        Args:
            command: Desired velocity [rad/s or m/s].
            velocity: Measured velocity [rad/s or m/s].
            period: Time since the last cycle [s], > 0.
        """
        return self._saturate(self._pid.compute_command(command - velocity, period))

    def _error(self, command: float, position: float) -> float:
        limit = self._limit
        if self._type is JointType.CONTINUOUS:
            return shortest_angular_distance(position, command)
        if self._type is not JointType.REVOLUTE or limit is None:
            return command - position
        if limit.lower is None or limit.upper is None:
            return command - position
        return shortest_angular_distance_with_limits(
            position, command, limit.lower, limit.upper
        )

    def _saturate(self, effort: float) -> float:
        if self._limit is None:
            return effort
        return max(-self._limit.effort, min(self._limit.effort, effort))


def read_simulated_pids(
    params: Parameters, joints: Mapping[str, Joint]
) -> dict[str, SimulatedPid]:
    """Return the controllers of the joints that have gains.

    Args:
        params: The namespace that has `pid_gains/<joint>`.
        joints: The joints that may have gains, by name.

    Raises:
        ParameterError: Gains are malformed, or belong to an unknown joint.
    """
    gains = params.namespace("pid_gains")
    pids = {}
    for name in gains.keys():  # noqa: SIM118 - no mapping
        if name not in joints:
            raise ParameterError(
                f"Parameter '{gains.resolve(name)}' names no joint with a motor.",
                remedy=f"Choose among {', '.join(joints) or 'none'}.",
                details={"parameter": gains.resolve(name)},
            )
        pids[name] = SimulatedPid(
            joints[name], Pid.from_parameters(gains.namespace(name))
        )
    return pids
