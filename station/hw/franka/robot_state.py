"""What the arm reports once per cycle, under libfranka's names.

Source: libfranka@0.9.2 include/franka/robot_state.h, RobotState; differs: plain lists
of floats that stay the same objects for the life of the arm, and time in seconds.
"""
# ruff: noqa: N815 - the names are libfranka's.

from dataclasses import dataclass, field
from enum import Enum


class RobotMode(Enum):
    """What the arm is doing; the values are libfranka's."""

    OTHER = 0
    IDLE = 1
    MOVE = 2
    GUIDING = 3
    REFLEX = 4
    USER_STOPPED = 5
    AUTOMATIC_ERROR_RECOVERY = 6


def _zeros() -> list[float]:
    return [0.0] * 7


@dataclass(slots=True)
class RobotState:
    """State of an arm with 7 joints.

    The arm owns the object and every list in it: it changes them in place in
    `RobotArm.read_once` and never replaces them, so a joint handle may keep a list. All
    others only read, in the control thread; whoever needs values elsewhere copies them.

    Attributes:
        q: Measured positions [rad].
        dq: Measured velocities [rad/s].
        tau_J: Measured link-side torques, gravity included [Nm].
        dtau_J: Their rate [Nm/s].
        q_d: Desired positions [rad].
        dq_d: Desired velocities [rad/s].
        ddq_d: Desired accelerations [rad/s^2].
        tau_J_d: Desired link-side torques without gravity; 0 when idle [Nm].
        theta: Motor-side positions [rad].
        dtheta: Motor-side velocities [rad/s].
        robot_mode: What the arm is doing.
        time: Since the arm was started [s]; strictly increasing.
        control_command_success_rate: Share of the last 100 commands that arrived, 0 to
            1; 0 while no motion runs.
    """

    q: list[float] = field(default_factory=_zeros)
    dq: list[float] = field(default_factory=_zeros)
    tau_J: list[float] = field(default_factory=_zeros)
    dtau_J: list[float] = field(default_factory=_zeros)
    q_d: list[float] = field(default_factory=_zeros)
    dq_d: list[float] = field(default_factory=_zeros)
    ddq_d: list[float] = field(default_factory=_zeros)
    tau_J_d: list[float] = field(default_factory=_zeros)
    theta: list[float] = field(default_factory=_zeros)
    dtheta: list[float] = field(default_factory=_zeros)
    robot_mode: RobotMode = RobotMode.OTHER
    time: float = 0.0
    control_command_success_rate: float = 0.0
