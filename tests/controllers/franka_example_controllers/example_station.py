"""A station over one simulated arm with one of the examples, stepped by hand."""

from collections.abc import Mapping
from typing import Any

from station.core.control.switching import SwitchRequest
from station.core.facade.station import Station
from station.core.franka.arms import Arms
from tests.franka_station import JOINTS, make_franka_station


def start_example(
    kind: str, params: Mapping[str, object] | None = None, **robot: Any
) -> Station:
    """Return a station in which the example has just been started.

    Args:
        kind: Its name without `ExampleController`.
        params: More parameters of the example.
        robot: More parameters of the robot; also `objects`.
    """
    station = make_franka_station(**robot)
    params = {"arm_id": "panda", "joint_names": JOINTS, **(params or {})}
    kind = f"franka_example_controllers/{kind}ExampleController"
    station.load_controller("example", kind, params)
    station.switch_controllers(SwitchRequest(("example",), ()))
    return station


def run_without_errors(station: Station, seconds: float) -> list[list[float]]:
    """Run, and return the measured end effector's origin [m] every 10 ms."""
    path = []
    for _ in range(round(seconds * 100)):
        station.loop.step(10)
        state = Arms(station.robots).state("panda")
        assert station.latest().mode == "move", station.controller("example").fault
        path.append(state.O_T_EE[12:15])
    return path
