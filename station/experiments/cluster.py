"""An executor over the workers of a Dask scheduler."""

import time
from collections.abc import Callable
from concurrent.futures import Executor, Future
from typing import ClassVar, ParamSpec, TypeVar

from distributed import Client, KilledWorker
from distributed.comm import parse_address, parse_host_port
from typing_extensions import override

from station.core.errors import StationError
from station.experiments.pools import Identity, compare, identity
from station.trials.errors import ExperimentError

P = ParamSpec("P")
T = TypeVar("T")


class ClusterExecutor(Executor):
    """Gives work to those workers of a cluster that compute the same as the caller.

    Dask repeats the tasks of a worker that is lost. Workers that join later are
    compared with the caller before they get work. A worker that differs gets no work,
    and `refused` says why.

    Args:
        address: Address of the scheduler, such as `tcp://host:8786`.
        setup_text: Text of the setup that the trials have.
        timeout: How long to wait for the scheduler, and for a first worker [s], > 0.
        look_after: Time between two checks for workers that joined or left [s].

    Attributes:
        refused: Reason for which a worker gets no work, by its address.
        worker_losses: Types of error of a task during which several workers have died.

    Raises:
        ExperimentError: The address is malformed, the scheduler does not answer, or has
            no worker that equals the caller.
    """

    worker_losses: ClassVar[tuple[type[BaseException], ...]] = (KilledWorker,)

    def __init__(
        self,
        address: str,
        setup_text: str,
        timeout: float = 30.0,
        look_after: float = 1.0,
    ) -> None:
        self.refused: dict[str, str] = {}
        self._setup_text = setup_text
        self._expected = identity(setup_text)
        self._good: set[str] = set()
        self._look_after = look_after
        _check_address(address)
        try:
            self._client = Client(address, timeout=timeout, set_as_default=False)
        except OSError as error:
            raise ExperimentError(
                f"The scheduler {address} does not answer in {timeout:g} s: {error}.",
                remedy="Start one with `dask scheduler`; docs/experiments.md says how.",
            ) from error
        deadline = time.monotonic() + timeout
        self._look_around()
        while not self._good:
            if time.monotonic() > deadline:
                reasons = " ".join(self.refused.values()) or "No worker has come."
                self._client.close()
                raise ExperimentError(
                    f"The scheduler {address} has no worker that fits. {reasons}",
                    remedy=f"Start one with `dask worker {address} --nthreads 1`, "
                    "where the same version of the station is installed.",
                )
            time.sleep(0.1)
            self._look_around()

    @property
    def worker_count(self) -> int:
        """Return the number of workers that get work."""
        return max(1, len(self._good))

    @override
    def submit(
        self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs
    ) -> Future[T]:
        if time.monotonic() - self._looked >= self._look_after:
            self._look_around()
        # Prefer these workers without requiring them: if all are lost, the task must
        # not wait for ever. The task itself compares its worker with the caller.
        found: Future[T] = self._executor.submit(fn, *args, **kwargs)
        return found

    @override
    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        self._client.close()

    def _look_around(self) -> None:
        """Compare the workers that joined, and forget the workers that left."""
        self._looked = time.monotonic()
        present = set(self._client.scheduler_info(n_workers=-1)["workers"])
        new = present - self._good - set(self.refused)
        good = self._good & present
        if new:
            answers = self._client.run(
                identity, self._setup_text, workers=list(new), on_error="return"
            )
            for worker, answer in answers.items():
                reason = self._difference(worker, answer)
                if reason is None:
                    good.add(worker)
                else:
                    self.refused[worker] = reason
        if good != self._good:
            self._good = good
            self._executor = self._client.get_executor(
                workers=sorted(good) or None, allow_other_workers=True, pure=False
            )

    def _difference(self, worker: str, answer: object) -> str | None:
        """Return the difference of a worker from the caller; None if they are equal."""
        if not isinstance(answer, Identity):
            return (
                f"Worker {worker} cannot run these trials: {answer}. Install the "
                "station there as it is here, and start it again."
            )
        try:
            compare(self._expected, answer, worker)
        except StationError as error:
            return f"{error.message} {error.remedy}"
        return None


def _check_address(address: str) -> None:
    """Refuse a malformed address.

    Raises:
        ExperimentError: The address is malformed.
    """
    try:
        parse_host_port(parse_address(address)[1])
    except ValueError as error:
        raise ExperimentError(
            f"{address!r} is no address of a scheduler: {error}.",
            remedy="Write it like tcp://host:8786.",
        ) from error
