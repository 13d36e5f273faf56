"""The client of a simulation: pause, step, reset."""

from collections.abc import Mapping

from station.client._async.connection import AsyncConnection
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


class AsyncSimulationClient:
    """The simulation of a station: `client.simulation`.

    Every method raises what the station client's own methods raise.

    Args:
        connection: The connection to the station.
    """

    def __init__(self, connection: AsyncConnection) -> None:
        self._connection = connection

    async def state(self) -> Simulation:
        """Return whether time passes, and how fast."""
        return await self._connection.get(_PATH, Simulation)

    async def bases(self) -> list[MovingBase]:
        """Return where the root links are of robots with a floating or planar base."""
        return (await self._connection.get("/scene", Scene)).bases

    async def contacts(self) -> list[Contact]:
        """Return where bodies of the world touch, and with which force."""
        return (await self._connection.get("/scene", Scene)).contacts

    async def pause(self) -> Simulation:
        """Pause simulated time; stops and switches still work."""
        return await self._change(SimulationPatch(paused=True))

    async def resume(self) -> Simulation:
        """Resume simulated time."""
        return await self._change(SimulationPatch(paused=False))

    async def set_real_time_factor(self, factor: float) -> Simulation:
        """Change the pace.

        Args:
            factor: Station time over wall time, more than 0, at most 100.
        """
        return await self._change(SimulationPatch(real_time_factor=factor))

    async def _change(self, patch: SimulationPatch) -> Simulation:
        return await self._connection.send("PATCH", _PATH, Simulation, patch)

    async def step(self, n: int = 1) -> Simulation:
        """Run some cycles while paused; return when they are done.

        Args:
            n: Number of cycles, 1 to 10000.
        """
        path, request = f"{_PATH}/step", StepRequest(n=n)
        return await self._connection.send(
            "POST", path, Simulation, request, patience=0.1 * n
        )

    async def reset(
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
        return await self._connection.send("POST", path, Simulation, request)
