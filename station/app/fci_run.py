"""A simulated Franka arm behind the Franka Control Interface, without a station."""

import contextlib
import logging
import time
from collections.abc import Callable
from dataclasses import replace

from station.app.composition import ROBOT_NAMESPACE, SCENE_NAMESPACE
from station.app.shutdown_signals import ShutdownSignals
from station.config import StationConfig
from station.core.errors import StationError
from station.core.parameters import Parameters, ParameterTree
from station.core.scheduling import (
    realtime_interpreter,
    request_realtime_priority,
)
from station.hw.franka.arm.arm_description import load_arm_description
from station.hw.franka.fci.server.fci_server import FciCounts, FciServer, FciSettings
from station.hw.franka.fci.server.model_library import (
    ModelLibraryError,
    build_model_library,
)
from station.hw.franka.fci.server.robot_model import write_robot_model
from station.hw.franka.fci.server.robot_session import ModelLibrary
from station.hw.franka.fci.wire.robot_protocol import protocols_of
from station.hw.franka.franka_parameters import FrankaParameters, read_parameters
from station.hw.franka.hand.hand_services import HandServices
from station.hw.franka.simulated.franka_world import simulate_one
from station.hw.franka.simulated.simulated_arm import SimulatedArm

ROBOT_TYPE = "franka_hw/FrankaHW"

_logger = logging.getLogger(__name__)


class FciRobotError(StationError, ValueError):
    """The configured robot is not a simulated Franka arm."""

    code = "fci_robot"


class FciRun:
    """The server of one simulated arm, from start to end, in the main thread.

    Args:
        config: The configuration, of which only robot and scene are used.
        settings: Address and protocol of the server.
        version: The only version of the protocol; None for all versions with a table.
        tell: Called with a line when clients can connect, and with one at the end.
        warn: Called with a line about a problem.
        desk_port: TCP port of Desk; None serves no Desk; then the brakes are open and
            FCI is active.
    """

    def __init__(
        self,
        config: StationConfig,
        settings: FciSettings,
        version: int | None = None,
        *,
        desk_port: int | None = None,
        tell: Callable[[str], None],
        warn: Callable[[str], None],
    ) -> None:
        self._config, self._settings, self._version = config, settings, version
        self._desk_port = desk_port
        self._tell = tell
        self._warn = warn

    def run(self) -> FciCounts:
        """Serve until SIGINT, SIGTERM or SIGHUP; return a summary.

        Raises:
            StationError: The robot or an address cannot be used.
        """
        with ShutdownSignals(lambda: None) as signals:
            with contextlib.suppress(KeyboardInterrupt):
                return self._run(lambda: signals.wait(0.0))
            return FciCounts()

    def _run(self, is_over: Callable[[], bool]) -> FciCounts:
        root = self._parameters()
        parameters = read_parameters(root.namespace(ROBOT_NAMESPACE))
        arm_id = parameters.arm_id
        if parameters.remark is not None:
            self._warn(parameters.remark)
        world = simulate_one(parameters, root)
        gripper = world.grippers.get(arm_id)
        hand = None if gripper is None else HandServices(arm_id, gripper)
        library = model_library_of(parameters, self._warn)
        protocols = protocols_of(parameters.arm, self._version)
        settings = replace(self._settings, protocols=protocols)
        arm = world.arms[arm_id]
        model = robot_model_of(parameters)
        server = FciServer(arm, hand, settings, library, robot_model=model)
        with contextlib.ExitStack() as stack:
            stack.enter_context(contextlib.closing(server))
            if self._desk_port is not None:
                kind = "FR3" if parameters.arm == "fr3" else "Panda"
                self._serve_desk(stack, server, arm, hand, kind=kind)
            stack.enter_context(realtime_interpreter())
            granted = request_realtime_priority()
            spoken = sorted(one.version for one in protocols)
            versions = " to ".join(map(str, dict.fromkeys((spoken[0], spoken[-1]))))
            self._tell(
                f"Franka Control Interface {versions} of arm '{arm_id}' at "
                f"{settings.host} ({granted})"
            )
            started = time.monotonic()
            try:
                server.run(is_over)
            finally:
                self._report(server.counts, time.monotonic() - started)
        return server.counts

    def _serve_desk(
        self,
        stack: contextlib.ExitStack,
        server: FciServer,
        arm: SimulatedArm,
        hand: HandServices | None,
        *,
        kind: str,
    ) -> None:
        """Serve Desk until the exit stack closes.

        Raises:
            StationError: The port or the certificate cannot be used.
        """
        # Imported here, because only Desk needs a web server.
        from station.hw.franka.fci.desk.desk_server import DeskServer, new_desk
        from station.hw.franka.fci.desk.desk_state import ServedArm

        host, port = self._settings.host, self._desk_port or 0
        desk = DeskServer(new_desk(ServedArm(server, arm, hand, kind)), host, port)
        stack.callback(desk.close)
        self._tell(
            f"Desk at https://{host}:{desk.port}; any name and password will do. "
            f"SHA-256 of its certificate: {desk.fingerprint}. Brakes closed, FCI off."
        )

    def _report(self, counts: FciCounts, duration: float) -> None:
        self._tell(
            f"{counts.cycles} cycles in {duration:.1f} s; {counts.commanded} of them "
            f"commanded by clients, {counts.lost} commands lost"
        )

    def _parameters(self) -> Parameters:
        """Return the robot's parameters as a station with this configuration has them.

        Raises:
            FciRobotError: The robot is not a single Franka arm.
        """
        kind = self._config.robot.type
        if kind != ROBOT_TYPE:
            raise FciRobotError(
                f"robot.type is '{kind}'; the Franka Control Interface serves "
                f"{ROBOT_TYPE} alone.",
                remedy=f"Choose a configuration with robot.type {ROBOT_TYPE}.",
            )
        return Parameters(
            ParameterTree({
                **self._config.parameters,
                ROBOT_NAMESPACE: self._config.robot_parameters(),
                SCENE_NAMESPACE: self._config.scene.model_dump(),
            })
        )


def robot_model_of(parameters: FrankaParameters) -> str:
    """Return the URDF of an arm for clients.

    Raises:
        RobotDescriptionError: The URDF of the arm cannot be used.
    """
    limits = parameters.limits
    description = load_arm_description(parameters.robot_description, limits)
    return write_robot_model(description, limits, parameters.arm)


def model_library_of(
    parameters: FrankaParameters, warn: Callable[[str], None]
) -> ModelLibrary:
    """Return the source of an arm's model library for clients.

    Args:
        parameters: The arm.
        warn: Called with a line if there is no model library for clients.

    Raises:
        RobotDescriptionError: The URDF cannot be used.
    """
    description = load_arm_description(parameters.robot_description, parameters.limits)
    try:
        return build_model_library(description)
    except ModelLibraryError as error:
        warn(f"Clients get no model library: {error} {error.remedy}")
        return lambda _architecture, _system: None
