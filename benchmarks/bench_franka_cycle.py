"""What a cycle of FrankaHW costs: read and write, without and with consumers.

Run `python benchmarks/bench_franka_cycle.py`; it prints microseconds per cycle, the
simulation's step included, for every kind of command and for readers of the state.
"""

import sys
import timeit
from collections.abc import Callable

from station.core.parameters import Parameters, ParameterTree
from station.core.robot_hw import ControllerInfo, InterfaceResources
from station.hw.franka.franka_hw import FrankaHW

CYCLES = 2_000
REPEATS = 7
PERIOD = 0.001
JOINTS = tuple(f"panda_joint{number}" for number in range(1, 8))
KINDS = {
    "idle": (),
    "effort": ("hardware_interface::EffortJointInterface",),
    "position": ("hardware_interface::PositionJointInterface",),
    "velocity": ("hardware_interface::VelocityJointInterface",),
}


def make(kind: str) -> FrankaHW:
    """Return a robot whose controllers command that kind."""
    tree = ParameterTree({
        "robot": {"arm_id": "panda", "robot_description": "example-robot-data:panda"}
    })
    hw = FrankaHW()
    hw.init(Parameters(tree), Parameters(tree, "robot"))
    claims = tuple(InterfaceResources(name, JOINTS) for name in KINDS[kind])
    if claims:
        hw.do_switch([ControllerInfo(kind, "bench/Controller", claims)], [])
    return hw


def measure(cycle: Callable[[], None]) -> float:
    """Return the best time of a cycle [us]."""
    return min(timeit.repeat(cycle, number=CYCLES, repeat=REPEATS)) / CYCLES * 1e6


def main() -> int:
    """Print the table."""
    for kind in KINDS:
        hw = make(kind)

        def cycle(hw: FrankaHW = hw) -> None:
            hw.read(0.0, PERIOD)
            hw.write(0.0, PERIOD)

        print(f"{kind:<12} {measure(cycle):6.1f} us")
    return 0


if __name__ == "__main__":
    sys.exit(main())
