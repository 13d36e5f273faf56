# Generated from _async/simulation_client.py by tools/generate_client.py.
"""The client of a simulation: pause, step, reset."""

from collections.abc import Mapping

from station.client._sync.connection import Connection
from station.wire import (
    Contact,
    MovingBase,
    ResetRequest,
    Scene,
    Simulation,
    SimulationPatch,
    StepRequest,
)

_PATH = "/simulation"


class SimulationClient:
    """The simulation of a station: `client.simulation`.

    Every method raises what the station client's own methods raise.

    Args:
        connection: The connection to the station.
    """

    def __init__(self, connection: Connection) -> None:
        self._connection = connection

    def state(self) -> Simulation:
        """Return whether time passes, and how fast."""
        return self._connection.get(_PATH, Simulation)

    def bases(self) -> list[MovingBase]:
        """Return where the root links are of robots with a floating or planar base."""
        return (self._connection.get("/scene", Scene)).bases

    def contacts(self) -> list[Contact]:
        """Return where bodies of the world touch, and with which force."""
        return (self._connection.get("/scene", Scene)).contacts

    def pause(self) -> Simulation:
        """Pause simulated time; stops and switches still work."""
        return self._change(SimulationPatch(paused=True))

    def resume(self) -> Simulation:
        """Resume simulated time."""
        return self._change(SimulationPatch(paused=False))

    def set_real_time_factor(self, factor: float) -> Simulation:
        """Change the pace.

        Args:
            factor: Station time over wall time, more than 0, at most 100.
        """
        return self._change(SimulationPatch(real_time_factor=factor))

    def _change(self, patch: SimulationPatch) -> Simulation:
        return self._connection.send("PATCH", _PATH, Simulation, patch)

    def step(self, n: int = 1) -> Simulation:
        """Run some cycles while paused; return when they are done.

        Args:
            n: Number of cycles, 1 to 10000.
        """
        path, request = f"{_PATH}/step", StepRequest(n=n)
        return self._connection.send(
            "POST", path, Simulation, request, patience=0.1 * n
        )

    def reset(
        self,
        joint_positions: Mapping[str, float] | None = None,
        keyframe: str | None = None,
    ) -> Simulation:
        """Put the world back to its start; earlier set-points and goals are void.

        Args:
            joint_positions: Joint name to position [rad or m]; the other joints go
                to the keyframe, or back to where they began.
            keyframe: Name of a pose to begin at; `get` lists the names.
        """
        request = ResetRequest(joint_positions=dict(joint_positions or {}))
        if keyframe is not None:
            request = request.model_copy(update={"keyframe": keyframe})
        path = f"{_PATH}/reset"
        return self._connection.send("POST", path, Simulation, request)
