"""The synchronous client of a simulation: pause, step, reset."""

from collections.abc import Callable, Mapping
from typing import Any

from station.client import calls
from station.client.calls import Call
from station.wire import Simulation


class SimulationClient:
    """The simulation of a station; `StationClient.simulation`.

    Every method raises what the client's own methods raise.

    Args:
        do: Sends a call and returns its answer.
    """

    def __init__(self, do: Callable[[Call[Any]], Any]) -> None:
        self._do = do

    def state(self) -> Simulation:
        """Return whether time passes, and how fast."""
        answer: Simulation = self._do(calls.simulation())
        return answer

    def pause(self) -> Simulation:
        """Let time stand still; stops and switches still work."""
        answer: Simulation = self._do(calls.change_simulation(paused=True))
        return answer

    def resume(self) -> Simulation:
        """Let time pass again."""
        answer: Simulation = self._do(calls.change_simulation(paused=False))
        return answer

    def set_real_time_factor(self, factor: float) -> Simulation:
        """Change the pace.

        Args:
            factor: Station time over wall time, more than 0, at most 100.
        """
        call = calls.change_simulation(real_time_factor=factor)
        answer: Simulation = self._do(call)
        return answer

    def step(self, n: int = 1) -> Simulation:
        """Run some cycles while paused; returns when they are done.

        Args:
            n: How many, 1 to 10000.
        """
        answer: Simulation = self._do(calls.step_simulation(n))
        return answer

    def reset(self, joint_positions: Mapping[str, float] | None = None) -> Simulation:
        """Put the world back to its start; what was commanded before is void.

        Args:
            joint_positions: Joint name to position [rad or m]; the others go back
                to where they began.
        """
        answer: Simulation = self._do(calls.reset_simulation(joint_positions or {}))
        return answer
