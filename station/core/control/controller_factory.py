"""Make loaded controllers out of names and parameters, in threads of their own.

Importing a plug-in, its constructor and its `init` are foreign code: they may take
seconds, hang, or call the manager. They run in a thread of their own and under no lock.
The caller waits for the controller up to a deadline and can cancel the loading; nothing
else waits.
"""

import inspect
import re
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from station.core.control.async_process import ProcessUpdate
from station.core.control.async_update import AsyncUpdate, ControllerHW
from station.core.control.chains import ChainedRobotHW, claims_of_references
from station.core.control.command_guard import find_guards
from station.core.control.controller import (
    ControllerBase,
    ControllerState,
    ControllerStatus,
)
from station.core.control.controller_loader import ControllerLoader, create_controller
from station.core.control.loaded_controller import LoadedController
from station.core.declared_parameter import (
    DeclaredParameter,
    NameKind,
    declare_boolean,
    declare_number,
    declare_strings,
)
from station.core.errors import (
    CONTAINED,
    ControllerLoadError,
    ParameterError,
    StationError,
    describe,
    trace_of_fault,
)
from station.core.hardware.async_function import (
    CYCLES,
    IS_ASYNC,
    POLICY,
    PROCESS,
    TIME_LIMIT,
    AsyncParams,
)
from station.core.hardware.robot_hw import ControllerInfo, InterfaceResources, RobotHW
from station.core.numerics.durations import DurationRing
from station.core.parameters import Parameters, unknown_parameters

LOAD_TIMEOUT = 60.0
"""Default of the wall time in which a controller must be loaded [s]."""


@dataclass(frozen=True, slots=True)
class ControllerType:
    """A type that can be loaded, and the parameters that it declares.

    Attributes:
        type: The type, usually `package/Class`.
        base_class: Name of the class of plugins that it belongs to.
        description: First line of the docstring of its class; empty without one.
        parameters: The parameters of every controller, and those that the type
            declares.
        error: Why its class cannot be imported; None when it can.
    """

    type: str
    base_class: str
    description: str = ""
    parameters: tuple[DeclaredParameter, ...] = ()
    error: str | None = None


FALLBACK = declare_strings(
    "fallback",
    "controllers that take over when this one fails",
    (),
    names=NameKind.CONTROLLER,
)
ALLOW_START_JUMP = declare_boolean(
    "allow_start_jump",
    "start even if the first command is far from the last command",
    default=False,
)
UPDATE_RATE = declare_number(
    "update_rate",
    "how often it is updated, at most as often as the loop; 0: every cycle",
    0.0,
    "Hz",
    minimum=0.0,
)
COMMON_PARAMETERS = (
    FALLBACK,
    ALLOW_START_JUMP,
    UPDATE_RATE,
    IS_ASYNC,
    POLICY,
    CYCLES,
    TIME_LIMIT,
    PROCESS,
)
"""Parameters that every controller has, whatever its type."""
_TOLD = 5
"""Number of unknown parameters that a refusal's message names; its details name all."""
# A name is a part of URLs and a namespace of parameters.
_NAME = re.compile(r"[A-Za-z0-9_]+(/[A-Za-z0-9_]+)*")


class ControllerFactory:
    """Creates and initialises controllers; outside of the control thread.

    Args:
        hw: The robot.
        parameters: Namespace in which each controller's parameters are under its name.
        loaders: The sources of controllers, asked in this order.
    """

    def __init__(
        self,
        hw: RobotHW,
        parameters: Parameters,
        loaders: Sequence[ControllerLoader],
    ) -> None:
        self.loaders = list(loaders)
        self._hw = hw
        self._parameters = parameters

    def declared_types(self) -> list[tuple[str, str]]:
        """Return (type, base class) of everything the loaders declare."""
        return [
            (controller_type, loader.name)
            for loader in self.loaders
            for controller_type in loader.declared_types()
        ]

    def describe_types(self) -> list[ControllerType]:
        """Return every type with the parameters that it declares.

        Modules that were not needed so far are imported. A type whose module cannot be
        imported, or whose declaration fails, is listed with the reason.
        """
        return [
            _describe_type(loader, controller_type)
            for loader in self.loaders
            for controller_type in loader.declared_types()
        ]

    def reload(self) -> None:
        """Let every loader forget the code it imported."""
        for loader in self.loaders:
            loader.reload()

    def build(
        self,
        name: str,
        loaded: Sequence[LoadedController] = (),
        *,
        strict: bool = False,
    ) -> LoadedController:
        """Return a new, initialised controller.

        Args:
            name: Name of the controller, and of its namespace.
            loaded: The loaded controllers, whose references the new one may claim.
            strict: Whether to refuse a parameter that the type does not know. The
                parameter is only noted if this is false, or if the type declares no
                parameters.

        Raises:
            ParameterError: Its type or a parameter is missing or impossible (CM-23), or
                unknown.
            ControllerTypeNotFoundError: No loader knows its type (CM-24).
            ControllerLoadError: The controller cannot be created or initialised (CM-25
                … CM-29).
        """
        if not _NAME.fullmatch(name):
            raise ControllerLoadError(
                f"'{name}' is no name for a controller.",
                remedy="Use letters, digits and '_', with '/' between namespaces.",
                details={"controller": name},
            )
        # Note the keys that `init` reads: a parameter that nothing reads is probably
        # misspelt.
        tree, reads = self._parameters.tree, set[str]()
        params = Parameters(tree, self._parameters.resolve(name), reads)
        controller_type = params.get_str("type")
        fallback = tuple(FALLBACK.read_str_list(params))
        if name in fallback:
            # A controller that fails in every update would start again in every cycle,
            # and be listed as running, without a fault.
            FALLBACK.refuse(params, list(fallback), "names of other controllers")
        may_jump = ALLOW_START_JUMP.read_bool(params)
        update_rate = UPDATE_RATE.read_float(params)
        asynchronous = AsyncParams.read(params, reads)
        controller = create_controller(self.loaders, controller_type)
        hw = self._hw
        exports = ChainedRobotHW(hw, loaded)
        # Without exports the controller gets the robot itself.
        seen = exports if exports.owners else hw
        private = None if asynchronous is None else ControllerHW(seen)
        claims = self._initialise(name, controller, params, private or seen)
        if private is not None:
            claims += private.undeclared_claims()
        claims, references, states = exports.split_claims(claims)
        notes = _unknown_parameters(name, controller, params, reads, strict=strict)
        notes += _hindrances(controller)
        info = ControllerInfo(name, controller_type, claims, references, states)
        loaded_controller = LoadedController(
            controller,
            info,
            find_guards(seen, (*claims, *claims_of_references(references))),
            fallback,
            may_jump=may_jump,
            notes=notes,
            following=exports.owners_of(references),
            read=exports.owners_of(states),
        )
        loaded_controller.update_rate = update_rate
        if private is not None and asynchronous is not None:
            outputs = loaded_controller.commands.slots
            loaded_controller.beside = (
                ProcessUpdate(controller, asynchronous, private, outputs, params)
                if asynchronous.has_process
                else AsyncUpdate(controller, asynchronous, private.storages(), outputs)
            )
        return loaded_controller

    def _initialise(
        self, name: str, controller: ControllerBase, params: Parameters, hw: RobotHW
    ) -> tuple[InterfaceResources, ...]:
        try:
            return controller.init_request(hw, params)
        # Its message names the parameter, and the API answers 422 for this type.
        except ParameterError:
            raise
        except StationError as error:
            raise ControllerLoadError(
                f"Controller '{name}' cannot be initialised: {error.message}",
                remedy=error.remedy + _load_order(name, error),
                details={**error.details, "controller": name, "cause": error.code},
            ) from error
        except CONTAINED as error:
            raise ControllerLoadError(
                f"Controller '{name}' cannot be initialised: its init raised "
                f"{describe(error)}.",
                remedy="Correct the controller's init.",
                details={"controller": name, "traceback": trace_of_fault()},
            ) from error


def _unknown_parameters(
    name: str,
    controller: ControllerBase,
    params: Parameters,
    reads: set[str],
    *,
    strict: bool,
) -> tuple[str, ...]:
    """Return a sentence about each parameter that is neither read nor declared.

    Raises:
        ParameterError: There is one, and `strict` is true.
    """
    declared = controller.declared_parameters()
    # A declaration may have the joint in its name, e.g. `gains/{joint}/p`.
    joints = controller.joint_names or [""]
    names = {each.of(joint).name for each in declared for joint in joints}
    names.update(controller.accepted_parameters)
    known = reads | {params.resolve(each) for each in names}
    unknown = unknown_parameters(params, known)
    # A controller that declares no parameters may read one at any time.
    if unknown and strict and declared:
        raise ParameterError(
            " ".join(
                f"Controller '{name}' has no parameter '{path}'. {meant}"
                for path, meant in unknown[:_TOLD]
            ),
            remedy="Correct the name, or leave the parameter out.",
            details={"controller": name, "parameters": [path for path, _ in unknown]},
        )
    return tuple(
        f"The parameter '{path}' is unknown and has no effect. {meant}"
        for path, meant in unknown
    )


def _hindrances(controller: ControllerBase) -> tuple[str, ...]:
    """Return a sentence about each call in `update` that delays the loop."""
    code = getattr(type(controller).update, "__code__", None)
    # A warning only: `print` may be the name of something harmless.
    if code is None or "print" not in code.co_names:
        return ()
    return (
        "Its update calls print, which writes in the control thread and makes cycles "
        "late. Set a sample or tunables to see values while it runs.",
    )


def _describe_type(loader: ControllerLoader, controller_type: str) -> ControllerType:
    try:
        found = loader.find_class(controller_type)
        declared = () if found is None else found.declared_parameters()
    except StationError as error:
        return ControllerType(controller_type, loader.name, error=error.message)
    except CONTAINED as error:  # of the plugin's module or its declaration
        return ControllerType(controller_type, loader.name, error=describe(error))
    text = inspect.cleandoc((found.__doc__ if found else "") or "")
    return ControllerType(
        controller_type,
        loader.name,
        text.partition("\n")[0],
        (*COMMON_PARAMETERS, *declared),
    )


class Loading:
    """A controller that is being loaded.

    Args:
        name: Name of the controller.
        build: Imports, creates and initialises the controller.

    Attributes:
        name: As given.
    """

    def __init__(self, name: str, build: Callable[[], LoadedController]) -> None:
        self.name = name
        self._build = build
        self._done = threading.Event()
        self._loaded: list[LoadedController] = []
        self._error: BaseException | None = None
        self._is_cancelled = False

    def load(self, timeout: float) -> LoadedController:
        """Load the controller in a thread of its own.

        Args:
            timeout: How long to wait for it [s wall time], > 0.

        Raises:
            ControllerLoadError: The loading took too long, or was cancelled. Its thread
                cannot be ended; a controller that it makes later is thrown away.
            BaseException: Whatever building it raised.
        """
        # A daemon thread: an import that never returns must not keep the process alive.
        thread = threading.Thread(
            target=self._run, name=f"load {self.name}", daemon=True
        )
        thread.start()
        if not self._done.wait(timeout):
            raise ControllerLoadError(
                f"Controller '{self.name}' was not loaded within {timeout:g} s: its "
                "import, its constructor or its init does not return.",
                remedy="Correct the controller. The thread that loads it goes on until "
                "it returns or the station ends; its result is thrown away.",
                details={"controller": self.name, "timeout": timeout},
            )
        if self._is_cancelled:
            raise ControllerLoadError(
                f"The loading of controller '{self.name}' was cancelled.",
                remedy="Load it again if you still want it.",
                details={"controller": self.name},
            )
        thread.join()  # it has set the event and ends
        if self._error is not None:
            # The error is not kept: its traceback would keep the controller alive.
            error, self._error = self._error, None
            try:
                raise error
            finally:
                del error
        return self._loaded.pop()

    def cancel(self) -> None:
        """Let the waiting caller go on without the controller."""
        self._is_cancelled = True
        # The event comes last: `load` looks at the flag when it wakes up.
        self._done.set()

    def status(self) -> ControllerStatus:
        """Return the status of the controller."""
        return ControllerStatus(
            self.name,
            "",
            ControllerState.LOADING,
            (),
            None,
            None,
            (),
            DurationRing(1).percentiles(),
        )

    def _run(self) -> None:
        try:
            self._loaded.append(self._build())
        except BaseException as error:  # noqa: BLE001 - handed to the caller
            self._error = error
        self._done.set()


def _load_order(name: str, error: StationError) -> str:
    """Return advice if a resource that is missing has the name of a reference."""
    owner, slash, _ = str(error.details.get("resource", "")).partition("/")
    if not slash:
        return ""
    if owner == name:
        return " A controller cannot command its own references."
    return f" References of a controller '{owner}' exist once it is loaded."
