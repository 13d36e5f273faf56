"""What an arm is sent in the cycles that a slow or a late loop has missed."""

from station.hw.franka.arm.arm_reading import ArmReading
from station.hw.franka.arm.robot_arm import MOST_LOST_PACKETS, RobotArm
from station.hw.franka.commands.command_sender import CommandSender


def catch_up(
    arm: RobotArm, sender: CommandSender, reading: ArmReading, most_lost: int
) -> int:
    """Read the arm once for each cycle that is due; return how many there are.

    When the loop is slower than the arm, the arm gets the last command again in its
    cycles within a nominal period, each time through filter and limits. The cycles that
    a late loop has missed are lost packets: the arm extrapolates its motion, and stops
    after 20 of them. Commanded poses are extrapolated by the sender, so that short
    delays lose no packet.

    Args:
        arm: The arm.
        sender: Sends the commands.
        reading: Knows the time that is due; it is taken from there.
        most_lost: As many cycles as the arm is made to miss.
    """
    cycles = round(reading.time_due / arm.cycle_time)
    reading.time_due -= cycles * arm.cycle_time
    late = min(cycles - reading.nominal, most_lost)
    bridged = sender.bridges_gaps and late < MOST_LOST_PACKETS
    lost = 0 if bridged else max(0, late)
    for cycle in range(min(cycles, reading.nominal + late)):
        if cycle > lost:
            sender.send_again()
        arm.read_once()
    return cycles
