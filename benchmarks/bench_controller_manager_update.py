"""What `ControllerManager.update` costs over the controllers it calls.

Run `python benchmarks/bench_controller_manager_update.py`; it prints microseconds per
cycle for 0, 1, 2, 5 and 10 running controllers that do nothing, each over seven joints,
next to the cost of the bare calls.
"""

from functools import partial

from measuring import REPEATS, median_time, print_table, print_title
from typing_extensions import override

from station.core.clock import SystemClock
from station.core.control.controller import Controller, ControllerBase
from station.core.control.controller_loader import TableLoader
from station.core.control.controller_manager import ControllerManager
from station.core.control.switching import SwitchRequest
from station.core.hardware.interfaces import (
    EffortJointInterface,
    JointHandle,
    JointStateHandle,
)
from station.core.hardware.robot_hw import RobotHW
from station.core.parameters import Parameters

JOINTS = 7
CYCLES = 20_000
PERIOD = 0.001


class Nothing(Controller[EffortJointInterface]):
    """Claims seven joints and does nothing."""

    hardware_interface = EffortJointInterface

    @override
    def init(self, interface: EffortJointInterface, params: Parameters) -> None:
        """Claim the joints."""
        for name in params.get_str_list("joints"):
            interface.get_handle(name)

    @override
    def update(self, time: float, period: float) -> None:
        """Do nothing."""


class ManyJoints(RobotHW):
    """Seven effort joints for each controller."""

    def __init__(self, count: int) -> None:
        super().__init__()
        values = [0.0] * count
        commands = [0.0] * count
        efforts = EffortJointInterface()
        for index in range(count):
            state = JointStateHandle(f"j{index}", values, values, values, index)
            efforts.register_handle(JointHandle(state, commands))
        self.register_interface(efforts)


def running_manager(controllers: int) -> ControllerManager:
    """Return a manager with that many running controllers."""
    parameters = Parameters()
    names = [f"c{number}" for number in range(controllers)]
    for number, name in enumerate(names):
        joints = [f"j{number * JOINTS + index}" for index in range(JOINTS)]
        parameters.set(name, {"type": "benchmark/Nothing", "joints": joints})
    manager = ControllerManager(
        ManyJoints(controllers * JOINTS),
        parameters,
        [TableLoader({"benchmark/Nothing": Nothing})],
        SystemClock(),
    )
    manager.pump = lambda: manager.update(0.0, PERIOD)
    for name in names:
        manager.load_controller(name)
    manager.switch_controller(SwitchRequest(start=names))
    return manager


def main() -> None:
    """Print the table."""
    rows: list[list[object]] = []
    for count in (0, 1, 2, 5, 10):
        manager = running_manager(count)
        controllers = [manager.get_controller(f"c{number}") for number in range(count)]
        update = median_time(partial(manager.update, 1.0, PERIOD), CYCLES)
        bare = median_time(partial(update_all, controllers), CYCLES)
        rows.append([count, update, bare, (update - bare) / max(count, 1)])
    print_title(f"ControllerManager.update [us], medians of {REPEATS} repeats")
    print_table(("controllers", "update", "bare calls", "over it, each"), rows)


def update_all(controllers: list[ControllerBase]) -> None:
    """Call the controllers as if there were no manager."""
    for controller in controllers:
        controller.update(1.0, PERIOD)


if __name__ == "__main__":
    main()
