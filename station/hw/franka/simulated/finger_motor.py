"""The motor of a hand's fingers: a servo with a limited lead, or a force."""

from station.hw.mujoco.simulator_memory import SimulatorMemory
from station.hw.mujoco.world_step import Preparation
from station.memory.doubles import Doubles


class FingerMotor(Preparation):
    """Drives the first finger of a simulated hand; the second finger mimics it.

    Args:
        simulator: The simulator's memory of the first finger.

    Attributes:
        stiffness: Stiffness of the servo [N/m]; 0 for a motor that gives a force.
        step: Change of `place` per time step, > 0 [m].
        reach: Largest distance of `place` from the finger [m].
        target: Position at which `place` ends [m].
        place: Position towards which the servo pulls the finger [m].
        force: Force on both fingers together without the servo [N].
    """

    def __init__(self, simulator: SimulatorMemory) -> None:
        self.simulator = simulator
        self.stiffness = 0.0
        self.step = 0.0
        self.reach = 0.0
        self.target = 0.0
        self.place = 0.0
        self.force = 0.0

    def prepare_step(self) -> None:
        """Set the motor's control for the coming step."""
        simulator = self.simulator
        if self.stiffness == 0.0:
            simulator.controls[0] = self.force
            return
        way, step = self.target - self.place, self.step
        if way < -step:
            way = -step
        if step < way:
            way = step
        place, position = self.place + way, simulator.positions[0]
        # A bounded lead bounds the force: otherwise the servo would press blocked
        # fingers more and more.
        if place < position - self.reach:
            place = position - self.reach
        if position + self.reach < place:
            place = position + self.reach
        self.place = place
        simulator.controls[0] = self.stiffness * place


class FingerSensor:
    """Reads the fingers of a simulated hand, which both have the same position.

    Args:
        simulator: The simulator's memory of the first finger.
        positions: Receives the position of each finger [m], shape (n,).
        velocities: Receives the velocity of each finger [m/s].
        efforts: Receives the force on each finger [N].
    """

    def __init__(
        self,
        simulator: SimulatorMemory,
        positions: Doubles,
        velocities: Doubles,
        efforts: Doubles,
    ) -> None:
        self.simulator = simulator
        self.positions = positions
        self.velocities = velocities
        self.efforts = efforts
        self.size = len(positions)

    def read(self) -> None:
        """Read the fingers."""
        simulator = self.simulator
        position, velocity = simulator.positions[0], simulator.velocities[0]
        # One motor drives both fingers.
        force = simulator.motor_forces[0] / 2.0
        positions, velocities, efforts = self.positions, self.velocities, self.efforts
        for i in range(self.size):
            positions[i] = position
            velocities[i] = velocity
            efforts[i] = force
