"""Update controllers in separate processes, each with its own Python interpreter.

A thread that computes in Python keeps the interpreter from the control thread. A
separate process does not: here the thread of an asynchronous update only sends the
states to the process, and sleeps until the commands come back. The control thread
treats such a controller as any other asynchronous one, and never talks to the process.

The process is started when the controller is loaded, so that it is ready when it is
needed. It initialises a second controller of the same class over copies of the same
handles. The controller in the station has the claims, the ports and the run-time
parameters.
"""

import io
import os
import pickle
import signal
import socket
import subprocess
import sys
import weakref
from array import array
from collections.abc import Callable, Mapping
from contextlib import suppress
from functools import partial
from multiprocessing.connection import Connection
from types import BuiltinMethodType, FunctionType, MethodType
from typing import Any, NamedTuple

from typing_extensions import override

from station.core.control.async_update import AsyncUpdate, ControllerHW
from station.core.control.chainable_controller import ChainableController
from station.core.control.controller import ControllerBase, ControllerSample
from station.core.errors import (
    CONTAINED,
    ControllerLoadError,
    StationError,
    describe,
    trace_of_fault,
)
from station.core.hardware.async_function import AsyncParams
from station.core.hardware.robot_hw import RobotHW
from station.core.parameters import Parameters, ParameterTree
from station.core.scheduling import ordinary_priority
from station.memory.doubles import Storage, doubles

_PATIENCE = 30.0
"""How long the process may take to start and to initialise the controller [s]."""
_GRACE = 1.0
"""Time after an update's time limit at which its process is ended [s]. It is wall time,
because station time may stand still."""


class AsyncProcessError(StationError, RuntimeError):
    """The process of an asynchronous controller has ended, hangs, or has failed."""

    code = "async_process"


class _Request(NamedTuple):
    """A request to the process to carry out one callback.

    Attributes:
        method: `update`, `stopping` or `aborting`.
        arguments: Its arguments.
        started: Station time at which the process first calls `starting` [s]; None if
            it does not.
        memory: Content of all storages, as bytes of doubles.
        tunables: The run-time parameters, if they have changed.
        set_point: Changes of the set-point, see `SetPointPort.take_changes`.
    """

    method: str
    arguments: tuple[float, ...]
    started: float | None
    memory: bytes
    tunables: Mapping[str, float] | None
    set_point: tuple[bool, list[float] | None, bool] | None


class _Answer(NamedTuple):
    """The results of a callback.

    Attributes:
        error: Exception of the callback, or None if it cannot be sent, with its text;
            None if the callback succeeded.
        memory: Content of all storages, as bytes of doubles.
        sample: The sample of the controller.
        messages: Its published messages.
    """

    error: tuple[BaseException | None, str] | None
    memory: bytes
    sample: ControllerSample | None
    messages: Mapping[str, Mapping[str, object]]


class _Pickler(pickle.Pickler):
    """Pickles handles with their memory, without the manager's data."""

    @override
    def reducer_override(self, obj: object) -> Any:
        if isinstance(obj, memoryview):
            return doubles, (obj.tolist(),)
        is_local = isinstance(obj, FunctionType) and "<" in obj.__qualname__
        if is_local or isinstance(obj, MethodType | BuiltinMethodType | partial):
            return _idle_function, ()
        return NotImplemented


def _idle_function() -> Callable[..., None]:
    return _do_nothing


def _do_nothing(*_: object) -> None:
    pass


class ProcessUpdate(AsyncUpdate):
    """Updates one controller in a process of its own.

    Args:
        controller: The controller, initialised over private copies.
        params: Policy, cycles and time limit of the updates.
        private: The copies.
        outputs: (storage, index) of the commands that the controller has claimed.
        namespace: The controller's namespace.

    Raises:
        ControllerLoadError: The controller cannot be in another process, or it cannot
            be initialised there.
    """

    def __init__(
        self,
        controller: ControllerBase,
        params: AsyncParams,
        private: ControllerHW,
        outputs: list[tuple[Storage, int]],
        namespace: Parameters,
    ) -> None:
        _refuse_what_has_no_way(controller)
        self._controller = controller
        self._memory = [copied for _, copied in private.storages()]
        self._limit = params.time_limit + _GRACE
        handles = {kind: list(view.handles()) for kind, view in private.views.items()}
        self._payload = _pickled(
            type(controller),
            (handles, self._memory, namespace.tree.get(""), namespace.path),
        )
        self._started: float | None = None
        # After a fork for a rehearsal, the copy must leave this process alone.
        self._owner = os.getpid()
        # The run-time parameters that the process has.
        self._told: Mapping[str, float] | None = None
        self._start_process()
        # Columns here would stay empty: the samples come from the other process.
        controller.sampled = None
        controller.starting = self._note_start  # type: ignore[method-assign]
        controller.update = partial(self._ask, "update")  # type: ignore[method-assign]
        controller.stopping = partial(self._ask, "stopping")  # type: ignore[method-assign]
        controller.aborting = partial(self._ask, "aborting")  # type: ignore[method-assign]
        controller.published = lambda: controller.messages  # type: ignore[method-assign]
        super().__init__(controller, params, private.storages(), outputs)

    @override
    def close(self) -> None:
        """End the process, even in the middle of a callback."""
        self._end_process()

    @override
    def _end_with(self, callback: Callable[[float], None], time: float) -> None:
        if self.is_stepped():
            super()._end_with(callback, time)
        else:
            # The control thread does not talk to the process: the thread of the updates
            # carries the callback out, and the next start waits for it.
            self.end(partial(callback, time), in_thread=True)

    def _note_start(self, time: float) -> None:
        # The commands are those of rest until the first update has ended.
        self._started = time

    def _ask(self, method: str, *arguments: float) -> None:
        """Have the process carry out a callback, and take over its results.

        Raises:
            AsyncProcessError: The process has ended, does not answer, or belongs to the
                station of which this station is a copy.
            BaseException: Whatever the callback raised.
        """
        if os.getpid() != self._owner:
            raise AsyncProcessError(
                "a copy of the station cannot ask the process of its updates",
                remedy="Stop this controller before a rehearsal.",
            )
        controller, ports = self._controller, self._controller.set_points
        tunables = controller.tunables.values
        request = _Request(
            method,
            arguments,
            self._started,
            b"".join(map(_bytes_of, self._memory)),
            None if tunables is self._told else tunables,
            ports.take_changes() if ports is not None and ports.has_changed() else None,
        )
        try:
            self._connection.send(request)
            if not self._connection.poll(self._limit):
                raise self._failure(f"has not answered for {self._limit:g} s")
            answer: _Answer = self._connection.recv()
        except (OSError, EOFError, AsyncProcessError) as error:
            known = error if isinstance(error, AsyncProcessError) else None
            failure = known or self._failure("has ended")
            self._end_process()
            if method == "update":
                raise failure from error
            # The controller has stopped with its process; its next start needs another.
            self._start_process()
            return
        self._started, self._told = None, tunables
        _fill(self._memory, answer.memory)
        controller.messages = answer.messages
        if answer.sample is not None:
            controller.sample = answer.sample
        if answer.error is not None:
            raised, text = answer.error
            raise raised or AsyncProcessError(text, remedy="Correct the controller.")

    def _failure(self, what: str) -> AsyncProcessError:
        code = None
        # The connection ends a moment before the process.
        with suppress(subprocess.TimeoutExpired):
            code = self._process.wait(0.2)
        ended = f" with the exit code {code}" if code is not None else ""
        kind = type(self._controller).__name__
        return AsyncProcessError(
            f"the process of its updates ({kind}, {self._process.pid}) {what}{ended}",
            remedy="Start the controller again; a new process is there.",
        )

    def _start_process(self) -> None:
        """Start the process, and wait until the controller is initialised in it.

        Raises:
            ControllerLoadError: The process or the controller did not start.
        """
        ours, theirs = socket.socketpair()
        with theirs, ordinary_priority():
            self._process = subprocess.Popen(
                [sys.executable, "-c", _MAIN, str(theirs.fileno())],
                pass_fds=[theirs.fileno()],
                stdin=subprocess.DEVNULL,
            )
        # The process ends with this object, and with the program.
        self._kill = weakref.finalize(self, _kill, self._process)
        self._connection = Connection(ours.detach())
        self._told = None
        problem = "it did not answer"
        with suppress(OSError, EOFError):
            self._connection.send(sys.path)
            self._connection.send_bytes(self._payload)
            if self._connection.poll(_PATIENCE):
                problem = self._connection.recv()
        if problem:
            self._end_process()
            raise ControllerLoadError(
                "The controller cannot be initialised in a process of its own: "
                f"{problem.strip().splitlines()[-1]}",
                remedy="Leave async_parameters/process out, or correct its init.",
                details={"traceback": problem},
            )

    def _end_process(self) -> None:
        self._kill()
        self._connection.close()


def _kill(process: "subprocess.Popen[bytes]") -> None:
    process.kill()
    process.wait()


def _refuse_what_has_no_way(controller: ControllerBase) -> None:
    """Refuse a controller whose goals or references would not reach the process.

    Raises:
        ControllerLoadError: The controller takes goals or exports references.
    """
    problem = ""
    if controller.goals is not None or controller.trajectories is not None:
        problem = "it takes goals"
    elif isinstance(controller, ChainableController):
        problem = "it exports references or states"
    if problem:
        raise ControllerLoadError(
            f"{type(controller).__name__} cannot be updated in a process of its own: "
            f"{problem}.",
            remedy="Leave async_parameters/process out.",
        )


def _pickled(kind: type, content: object) -> bytes:
    """Return the class and the handles, pickled for the process.

    Raises:
        ControllerLoadError: The class cannot be imported elsewhere, or a handle has
            something that cannot be copied.
    """
    problem: Exception | str = "it is defined in the program itself"
    try:
        reference = pickle.dumps(kind)
        stream = io.BytesIO()
        _Pickler(stream).dump(content)
        if kind.__module__ != "__main__":
            return pickle.dumps((reference, stream.getvalue()))
    except (pickle.PicklingError, AttributeError, TypeError) as error:
        problem = error
    raise ControllerLoadError(
        f"{kind.__name__} cannot be updated in a process of its own: {problem}.",
        remedy="Put the class into a module that can be imported, or leave "
        "async_parameters/process out.",
    )


def _bytes_of(storage: Storage) -> bytes:
    return (array("d", storage) if isinstance(storage, list) else storage).tobytes()


def _fill(storages: list[Storage], memory: bytes) -> None:
    """Write bytes, as `_bytes_of` returns them, into the storages."""
    numbers, at = memoryview(memory).cast("d"), 0
    for storage in storages:
        part = numbers[at : at + len(storage)]
        storage[:] = part.tolist() if isinstance(storage, list) else part  # type: ignore[assignment]
        at += len(storage)


# With `-m` the module would exist twice, and its classes could not be unpickled.
_MAIN = "from station.core.control.async_process import serve; serve()"


class _ViewsHW(RobotHW):
    """A robot with the handles that the station's controller has."""

    def __init__(self, views: Mapping[type, list[Any]]) -> None:
        super().__init__()
        self._views: dict[type, Any] = {}
        for kind, handles in views.items():
            self._views[kind] = kind()
            for handle in handles:
                self._views[kind].register_handle(handle)

    @override
    def get(self, interface_type: type[Any]) -> Any:
        return self._views.get(interface_type)


def serve() -> None:
    """Initialise a controller and carry out its callbacks, until the station ends."""
    # The process ignores the station's signals: it ends with the connection.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    connection = Connection(int(sys.argv[1]))
    sys.path[:] = connection.recv()
    try:
        reference, content = pickle.loads(connection.recv_bytes())
        controller: ControllerBase = pickle.loads(reference)()
        views, memory, tree, path = pickle.loads(content)
        controller.init_request(_ViewsHW(views), Parameters(ParameterTree(tree), path))
    except CONTAINED:
        connection.send(trace_of_fault())
        return
    connection.send("")
    with suppress(EOFError, OSError):
        while True:
            connection.send(_carry_out(controller, memory, connection.recv()))


def _carry_out(
    controller: ControllerBase, memory: list[Storage], request: _Request
) -> _Answer:
    error: tuple[BaseException | None, str] | None = None
    messages: Mapping[str, Mapping[str, object]] = {}
    _fill(memory, request.memory)
    try:
        if request.tunables is not None:
            controller.tunables.apply(request.tunables)
        if request.set_point is not None and controller.set_points is not None:
            controller.set_points.follow_changes(request.set_point)
        if request.started is not None:
            controller.starting(request.started)
        getattr(controller, request.method)(*request.arguments)
        messages = controller.published()
    except CONTAINED as raised:
        error = (raised if _can_be_sent(raised) else None, describe(raised))
    content = b"".join(map(_bytes_of, memory))
    return _Answer(error, content, controller.sample, messages)


def _can_be_sent(error: BaseException) -> bool:
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:  # noqa: BLE001 - it is told by its text
        return False
    return True
