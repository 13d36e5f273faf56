"""Read an arm in every cycle of the loop."""

from typing import TYPE_CHECKING

from station.hw.franka.commands.command_sender import CommandSender
from station.memory.vectors import FiniteCheck

if TYPE_CHECKING:
    from collections.abc import Callable

    from station.hw.franka.arm.robot_arm import RobotArm
    from station.hw.franka.commands.motion_start import MotionStart

_READINGS = ("position", "velocity", "torque")


class ArmReading:
    """Reads an arm once per elapsed cycle time. Control thread only.

    Args:
        arm: The arm.
        motion: The motion that may wait for the arm.
        sender: Sends commands in the cycles between two cycles of the loop.
        most_lost: Largest number of cycles in which a late loop gives no command.
        losses_that_end: Number of commands lost in a row that ends a motion.

    Attributes:
        nominal: Cycles of the arm per cycle of the loop.
        read_fingers: Reads the fingers; None without a simulated hand.
    """

    def __init__(
        self,
        arm: "RobotArm",
        motion: "MotionStart",
        sender: CommandSender,
        *,
        most_lost: int,
        losses_that_end: int,
    ) -> None:
        self.arm = arm
        self.read_once = arm.read_once
        self.joint_readings = arm.state.readings()
        self.readings = FiniteCheck(self.joint_readings)
        self.motion = motion
        self.sender = sender
        self.cycle_time = arm.cycle_time
        self.most_lost = most_lost
        self.losses_that_end = losses_that_end
        self.read_fingers: Callable[[], object] | None = None
        self.time_due = 0.0
        self.nominal = 1
        self.bad = -1  # number of a reading that is not finite

    def read(self, time: float, period: float) -> None:
        """Read the arm once for each of its cycles that has elapsed.

        Args:
            time: Station time of the cycle [s].
            period: Time since the last cycle [s], >= 0.
        """
        # The remainder is kept, so that a loop whose period is not a multiple of the
        # arm's cycle keeps its rate.
        self.time_due += period
        share, count = self.time_due / self.cycle_time, 1
        # The usual cycle has one state, and needs no arithmetic for late ones.
        if self.nominal == 1 and 0.5 < share < 1.5:
            self.time_due -= self.cycle_time
            read_once = self.read_once
            read_once()
        else:
            count = self.catch_up()
        if self.sender.is_waiting:
            self.motion.advance(count)
        self.bad = self.readings.first_bad()
        if self.bad >= 0:
            # Controllers would compute nonsense from such a reading.
            self.arm.stop_motion()
        read_fingers = self.read_fingers
        if read_fingers is not None:
            read_fingers()

    def catch_up(self) -> int:
        """Read the arm once for each cycle that is due; return their number.

        If the loop is slower than the arm, the arm gets the last command again in each
        of its cycles within a nominal period, through filter and limits. Cycles that a
        late loop has missed are lost packets: the arm extrapolates its motion, and
        stops after 20 of them. The sender extrapolates commanded poses, so short delays
        lose no packet of a motion of poses.
        """
        cycles = round(self.time_due / self.cycle_time)
        self.time_due -= cycles * self.cycle_time
        # A longer gap is not made up for: reading the arm so often would delay the loop
        # even more.
        late = min(cycles - self.nominal, self.most_lost)
        # libfranka extrapolates poses; a longer gap ends the motion on a real arm, too.
        bridged = self.sender.bridges_gaps and late < self.losses_that_end
        lost = 0 if bridged else max(0, late)
        for cycle in range(min(cycles, self.nominal + late)):
            if cycle > lost:
                self.sender.resend_commands()
            self.read_once()
        return cycles

    def blindness(self) -> str | None:
        """Return the reading that was not finite at the last `read`, or None."""
        if self.bad < 0:
            return None
        reading, joint = divmod(self.bad, 7)
        value = self.joint_readings[self.bad]
        return f"the {_READINGS[reading]} of joint{joint + 1} reads {value}"
