# Generated from _async/experiments_client.py by tools/generate_client.py.
"""The client of a station's experiments."""

import time
from collections.abc import Callable, Mapping

from station.client._sync.connection import Connection
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


class ExperimentsClient:
    """Experiments that run beside the station: `client.experiments`.

    Every method raises what the station client's own methods raise.

    Args:
        connection: The connection to the station.
    """

    def __init__(self, connection: Connection) -> None:
        self._connection = connection

    def start(self, request: ExperimentRequest) -> Experiment:
        """Start an experiment; one runs at a time. The robot does not move.

        Args:
            request: What to do, such as `ExperimentRequest(kind="tune",
                controller="effort_joint_trajectory_controller")`.
        """
        return self._connection.send(
            "POST", _PATH, Experiment, request, patience=_CHECKING
        )

    def get(self, name: str) -> Experiment:
        """Return how far an experiment is, its first trial and the best so far."""
        return self._connection.get(_path(name), Experiment)

    def wait(
        self, name: str, watch: Callable[[Experiment], None] | None = None
    ) -> Experiment:
        """Wait until an experiment does not run any more; return it.

        Args:
            name: The experiment.
            watch: Is called with it twice a second.
        """
        found = self.get(name)
        while found.state == "running":
            if watch is not None:
                watch(found)
            time.sleep(_PERIOD)
            found = self.get(name)
        if watch is not None:
            watch(found)
        return found

    def cancel(self, name: str) -> Experiment:
        """End the experiment that runs; trials that run may end."""
        return self._connection.send("POST", f"{_path(name)}/cancel", Experiment)

    def delete(self, name: str) -> Experiment:
        """Delete an experiment that does not run; return what it was."""
        return self._connection.send("DELETE", _path(name), Experiment)

    def trials(
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
        return (self._connection.get(path, ExperimentTrials, query)).trials

    def best(
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
        return (self._connection.get(path, ExperimentTrials, query)).trials

    def responses(self, name: str) -> list[ExperimentResponse]:
        """Return the responses that were kept: first and best trial, or the worst."""
        path = f"{_path(name)}/responses"
        return (self._connection.get(path, ExperimentResponses)).responses

    def preview(self, name: str, trial: str | None = None) -> ExperimentPreview:
        """Return which gains would change if those of a trial were put into force.

        Args:
            name: The experiment.
            trial: Hash of the trial, or the beginning of it; the best when None.
        """
        query = {} if trial is None else {"trial": trial}
        path = f"{_path(name)}/preview"
        return self._connection.get(path, ExperimentPreview, query)

    def apply(
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
        answer = self._connection.send("POST", path, GainsChanges, request)
        return answer.changes

    def list(self) -> list[ExperimentSummary]:
        """Return the experiments, sorted by name."""
        return (self._connection.get(_PATH, Experiments)).experiments


def _path(name: str) -> str:
    return f"{_PATH}/{segment(name)}"
