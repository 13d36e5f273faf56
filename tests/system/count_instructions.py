"""Print the instructions of Python in a cycle of an arm, by the controller that runs.

Run with the names of the controllers; `none` runs none of them.
"""

import json
import sys

from station.app.composition import compose
from station.config import load_config
from station.core.control.switching import SwitchRequest
from station.core.facade.station import Station

CYCLES = 20


def count_instructions(station: Station) -> float:
    """Return the mean number of instructions in a cycle."""
    counted = 0

    def trace(frame, event, _):
        nonlocal counted
        frame.f_trace_opcodes, frame.f_trace_lines = True, False
        counted += event == "opcode"
        return trace

    sys.settrace(trace)
    station.loop.step(CYCLES)
    sys.settrace(None)
    return counted / CYCLES


def _station(controller: str) -> Station:
    robot = {"type": "franka_hw/FrankaHW", "realism": "ideal"}
    station = compose(load_config({"robot": robot, "start": []})).station
    if controller != "none":
        station.switch_controllers(SwitchRequest(start=(controller,)))
    station.loop.step(500)  # until the arm rests under it
    return station


if __name__ == "__main__":
    counted = {name: count_instructions(_station(name)) for name in sys.argv[1:]}
    sys.stdout.write(json.dumps(counted))
