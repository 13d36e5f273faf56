"""A robot of one joint and the loop around it, for the tests of the loop."""

import threading

from station.core.clock import Clock, ManualClock
from station.core.control.controller_manager import ControllerManager
from station.core.hardware.interfaces import JointStateHandle, JointStateInterface
from station.core.hardware.robot_hw import RobotHW
from station.core.loop.control_loop import ControlLoop
from station.core.parameters import Parameters
from tests.waiting import PATIENCE

PERIOD = 0.001


class OneJoint(RobotHW):
    """A joint that counts reads and can be told to fail or to be slow."""

    def __init__(self, clock: ManualClock | None = None) -> None:
        super().__init__()
        self.position = [0.0]
        joints = JointStateInterface()
        joints.register_handle(JointStateHandle("j", self.position, [0.0], [0.0]))
        self.register_interface(joints)
        self.clock = clock
        self.durations: list[float] = []
        self.periods: list[float] = []
        self.fail_in_cycle = 0
        self.error: BaseException = RuntimeError("the cable is out")
        self.cycles_done = threading.Event()
        self.cycles_wanted = 0

    def read(self, time: float, period: float) -> None:
        self.position[0] = time
        self.periods.append(period)
        if len(self.periods) == self.fail_in_cycle:
            raise self.error
        if self.clock is not None and self.durations:
            self.clock.advance(self.durations.pop(0))

    def write(self, time: float, period: float) -> None:
        if len(self.periods) == self.cycles_wanted:
            self.cycles_done.set()


def make_loop(
    hw: OneJoint, clock: Clock | None = None, **options: float
) -> ControlLoop:
    """Return the loop of a joint, on a manual clock unless told otherwise."""
    clock = clock or ManualClock()
    manager = ControllerManager(hw, Parameters(), [], clock)
    return ControlLoop(hw, manager, clock=clock, period=PERIOD, **options)


def run_thread(hw: OneJoint, loop: ControlLoop, cycles: int) -> None:
    """Run the thread of a loop for at least `cycles` cycles."""
    hw.cycles_wanted = cycles
    loop.start()
    assert hw.cycles_done.wait(PATIENCE)
    loop.stop()
