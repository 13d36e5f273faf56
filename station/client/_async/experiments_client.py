"""The client of a station's experiments."""

import asyncio
from collections.abc import Callable, Mapping

from station.client._async.connection import AsyncConnection
from station.client.routes import segment
from station.wire import ExperimentRequest, GainsChange, GainsChanges
from station.wire.experiments import (
    Experiment,
    ExperimentApplyRequest,
    ExperimentPreview,
    ExperimentResponse,
    ExperimentResponses,
    Experiments,
    ExperimentSummary,
    ExperimentTrial,
    ExperimentTrials,
)

_PATH = "/experiments"
_PERIOD = 0.5
"""Time between two looks at an experiment that runs [s]."""
_CHECKING = 60.0
"""How much longer than usual the start of an experiment may take [s]."""


class AsyncExperimentsClient:
    """Experiments that run beside the station: `client.experiments`.

    Every method raises what the station client's own methods raise.

    Args:
        connection: The connection to the station.
    """

    def __init__(self, connection: AsyncConnection) -> None:
        self._connection = connection

    async def start(self, request: ExperimentRequest) -> Experiment:
        """Start an experiment; one runs at a time. The robot does not move.

        Args:
            request: What to do, such as `ExperimentRequest(kind="tune",
                controller="effort_joint_trajectory_controller")`.
        """
        return await self._connection.send(
            "POST", _PATH, Experiment, request, patience=_CHECKING
        )

    async def get(self, name: str) -> Experiment:
        """Return how far an experiment is, its first trial and the best so far."""
        return await self._connection.get(_path(name), Experiment)

    async def wait(
        self, name: str, watch: Callable[[Experiment], None] | None = None
    ) -> Experiment:
        """Wait until an experiment does not run any more; return it.

        Args:
            name: The experiment.
            watch: Is called with it twice a second.
        """
        found = await self.get(name)
        while found.state == "running":
            if watch is not None:
                watch(found)
            await asyncio.sleep(_PERIOD)
            found = await self.get(name)
        if watch is not None:
            watch(found)
        return found

    async def cancel(self, name: str) -> Experiment:
        """End the experiment that runs; trials that run may end."""
        return await self._connection.send("POST", f"{_path(name)}/cancel", Experiment)

    async def delete(self, name: str) -> Experiment:
        """Delete an experiment that does not run; return what it was."""
        return await self._connection.send("DELETE", _path(name), Experiment)

    async def trials(
        self, name: str, after: int = 0, count: int = 100
    ) -> list[ExperimentTrial]:
        """Return trials that have ended, in the order of ending.

        Args:
            name: The experiment.
            after: Number of the last trial that is known.
            count: How many at most, 1 to 500.
        """
        query = {"after": str(after), "count": str(count)}
        path = f"{_path(name)}/trials"
        return (await self._connection.get(path, ExperimentTrials, query)).trials

    async def best(
        self, name: str, count: int = 5, metric: str | None = None
    ) -> list[ExperimentTrial]:
        """Return the best trials, the best first.

        Args:
            name: The experiment.
            count: How many at most, 1 to 500.
            metric: What decides; the experiment's own goal or metric when None.
        """
        query = {"count": str(count)}
        if metric is not None:
            query["metric"] = metric
        path = f"{_path(name)}/best"
        return (await self._connection.get(path, ExperimentTrials, query)).trials

    async def responses(self, name: str) -> list[ExperimentResponse]:
        """Return the responses that were kept: first and best trial, or the worst."""
        path = f"{_path(name)}/responses"
        return (await self._connection.get(path, ExperimentResponses)).responses

    async def preview(self, name: str, trial: str | None = None) -> ExperimentPreview:
        """Return which gains would change if those of a trial were put into force.

        Args:
            name: The experiment.
            trial: Hash of the trial, or the beginning of it; the best when None.
        """
        query = {} if trial is None else {"trial": trial}
        path = f"{_path(name)}/preview"
        return await self._connection.get(path, ExperimentPreview, query)

    async def apply(
        self,
        name: str,
        trial: str | None = None,
        revisions: Mapping[str, int] | None = None,
    ) -> Mapping[str, GainsChange]:
        """Put the gains of a trial into force in one cycle, and save them as a set.

        Args:
            name: The experiment, and the name of the gain set.
            trial: Hash of the trial, or the beginning of it; the best when None.
            revisions: Those of the preview; refused when the gains have changed since.
        """
        request = ExperimentApplyRequest(
            trial=trial, revisions=None if revisions is None else dict(revisions)
        )
        path = f"{_path(name)}/apply"
        answer = await self._connection.send("POST", path, GainsChanges, request)
        return answer.changes

    async def list(self) -> list[ExperimentSummary]:
        """Return the experiments, sorted by name."""
        return (await self._connection.get(_PATH, Experiments)).experiments


def _path(name: str) -> str:
    return f"{_PATH}/{segment(name)}"
