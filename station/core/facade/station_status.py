"""The station at a glance, for status displays."""

from dataclasses import dataclass

from station.compiled import CompilationStatus
from station.core.hardware.robot_hw import RobotHW
from station.core.hardware.robot_report import ClampReport
from station.core.loop.stop_latch import StopState
from station.reports import LoopReport, Simulation


@dataclass(frozen=True, slots=True)
class StationStatus:
    """The station at a glance.

    Attributes:
        boot_id: Changes with every start of the process.
        epoch: Commands from an older epoch are void.
        time: Station time [s].
        cycle: Number of the last cycle.
        robot_type: Type of the robot, `package/Class`.
        robot_label: SIMULATION, or REAL ARM with its address, for people.
        robot_mode: The robot's mode in one word.
        stop_state: State of the latched stop.
        stop_reason: Why it was engaged last.
        loop: How the loop is doing.
        kernel: Whether the arithmetic of the cycle runs interpreted or compiled.
        simulation: The simulation at a glance; None for a real robot.
        clamps: What limits have cut off.
        command_violations: How often somebody wrote a command without a claim.
        last_command_violation: Who wrote what last; None without one.
    """

    boot_id: str
    epoch: int
    time: float
    cycle: int
    robot_type: str
    robot_label: str
    robot_mode: str
    stop_state: StopState
    stop_reason: str
    loop: LoopReport
    kernel: CompilationStatus
    simulation: Simulation | None
    clamps: tuple[ClampReport, ...]
    command_violations: int
    last_command_violation: str | None


def label_robot(hw: RobotHW) -> str:
    """Return the label that tells people whether something real moves.

    Args:
        hw: The robot; one of several counts as real if any of them is.
    """
    if hw.simulated_world() is not None:
        return "SIMULATION"
    address = hw.address()
    return f"REAL ARM {address}" if address else "REAL ROBOT"
