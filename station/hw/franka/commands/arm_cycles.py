"""How many cycles an arm makes in a cycle of the loop, and what it is sent in them."""

from math import inf

from station.hw.franka.arm.loop_period import arm_cycles_of
from station.hw.franka.arm.robot_arm import MOST_LOST_PACKETS, RobotArm
from station.hw.franka.commands.command_sender import CommandSender


class ArmCycles:
    """Reads an arm once per elapsed cycle time. Control thread only.

    When the loop is slower than the arm, the arm gets the last command again in its
    cycles within a nominal period, each time through filter and limits. The cycles that
    a late loop has missed are lost packets: the arm extrapolates its motion, and stops
    after 20 of them. Commanded poses are extrapolated by the sender, so that short
    delays lose no packet.

    Args:
        arm: The arm.
        sender: Sends the commands.
        most_lost: As many cycles as the arm is made to miss when the loop is late.

    Attributes:
        nominal: Cycles of the arm in a nominal period of the loop.
    """

    def __init__(self, arm: RobotArm, sender: CommandSender, most_lost: int) -> None:
        self._arm, self._sender, self._most_lost = arm, sender, most_lost
        self._cycle_time = arm.cycle_time
        self._time_due = 0.0
        self.nominal = 1

    def plan(self, period: float, arm_id: str, *, is_real: bool) -> None:
        """Settle how many cycles a nominal period has; see `arm_cycles_of`.

        Raises:
            HardwareInterfaceError: The arm cannot live with this period.
        """
        time = self._cycle_time
        self.nominal = arm_cycles_of(period, time, arm_id, is_real=is_real)

    def read(self, period: float) -> int:
        """Bring the arm's state up to date; return how many cycles have elapsed.

        Args:
            period: Time since the last cycle of the loop [s], >= 0.
        """
        self._time_due += period
        cycles = round(self._time_due / self._cycle_time)
        self._time_due -= cycles * self._cycle_time
        if cycles == 1 == self.nominal:
            self._arm.read_once()
        else:
            self._catch_up(cycles)
        return cycles

    def longest_period(self) -> float:
        """Return how long a simulated world goes on without the loop [s]."""
        waits = self._most_lost < MOST_LOST_PACKETS
        return (self.nominal + self._most_lost) * self._cycle_time if waits else inf

    def _catch_up(self, cycles: int) -> None:
        """Read the arm once for each of several cycles, or none."""
        late = min(cycles - self.nominal, self._most_lost)
        bridged = self._sender.bridges_gaps and late < MOST_LOST_PACKETS
        lost = 0 if bridged else max(0, late)
        for cycle in range(min(cycles, self.nominal + late)):
            if cycle > lost:
                self._sender.send_again()
            self._arm.read_once()
