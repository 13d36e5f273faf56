"""A simulated Franka arm behind the Franka Control Interface, without a station."""

import time
from collections.abc import Callable, Mapping
from contextlib import ExitStack, closing, suppress
from dataclasses import KW_ONLY, dataclass

from station.app.composition import ROBOT_NAMESPACE, root_parameters
from station.app.shutdown_signals import ShutdownSignals
from station.config import StationConfig
from station.core.errors import StationError
from station.core.scheduling import realtime_interpreter, request_realtime_priority
from station.hw.franka.arm.arm_description import load_arm_description
from station.hw.franka.fci.desk.desk_state import Desk
from station.hw.franka.fci.server.fci_server import FciCounts, FciServer, FciSettings
from station.hw.franka.fci.server.model_library import (
    ModelLibraryError,
    build_model_library,
)
from station.hw.franka.fci.server.robot_model import write_robot_model
from station.hw.franka.fci.server.robot_session import ClientFeatures
from station.hw.franka.fci.wire.robot_protocol import protocols_of
from station.hw.franka.franka_parameters import FrankaParameters, read_parameters
from station.hw.franka.hand.hand_services import HandServices
from station.hw.franka.simulated.franka_world import simulate_one

ROBOT_TYPE = "franka_hw/FrankaHW"


class FciRobotError(StationError, ValueError):
    """The configured robot is not a simulated Franka arm."""

    code = "fci_robot"


@dataclass(frozen=True, slots=True)
class FciRun:
    """The server of one simulated arm, from start to end, in the main thread.

    Attributes:
        config: The configuration, of which only robot and scene are used.
        settings: Address and timing of the server.
        version: The only version of the protocol; None for all versions with a table.
        desk_port: TCP port of Desk; None serves no Desk; then the brakes are open and
            FCI is active.
        tell: Called with a line when clients can connect, and with one at the end.
        warn: Called with a line about a problem.
    """

    config: StationConfig
    settings: FciSettings
    version: int | None = None
    _: KW_ONLY
    desk_port: int | None = None
    tell: Callable[[str], None]
    warn: Callable[[str], None]

    def run(self) -> FciCounts:
        """Serve until SIGINT, SIGTERM or SIGHUP; return a summary.

        Raises:
            FciRobotError: The robot is not a single Franka arm.
            StationError: The robot or an address cannot be used.
        """
        kind = self.config.robot.type
        if kind != ROBOT_TYPE:
            raise FciRobotError(
                f"robot.type is '{kind}'; the Franka Control Interface serves "
                f"{ROBOT_TYPE} alone.",
                remedy=f"Choose a configuration with robot.type {ROBOT_TYPE}.",
            )
        with ShutdownSignals(lambda: None) as signals, suppress(KeyboardInterrupt):
            return self._run(lambda: signals.wait(0.0))
        return FciCounts()

    def _run(self, is_over: Callable[[], bool]) -> FciCounts:
        root = root_parameters(self.config)
        parameters = read_parameters(root.namespace(ROBOT_NAMESPACE))
        arm_id = parameters.arm_id
        if parameters.remark is not None:
            self.warn(parameters.remark)
        world = simulate_one(parameters, root)
        arm, gripper = world.arms[arm_id], world.grippers.get(arm_id)
        hand = None if gripper is None else HandServices(arm_id, gripper)
        features = features_of(parameters, self.version, self.warn)
        host = self.settings.host
        server = FciServer(arm, hand, self.settings, features)
        with ExitStack() as stack:
            stack.enter_context(closing(server))
            if self.desk_port is not None:
                # Imported here, because only Desk needs a web server.
                from station.hw.franka.fci.desk.desk_server import DeskServer

                desk = Desk(server, arm, hand, parameters.arm)
                desk.reboot()
                served = DeskServer(desk, host, self.desk_port)
                stack.callback(served.close)
                self.tell(
                    f"Desk at https://{host}:{served.port}; any name and "
                    "password will do. SHA-256 of its certificate: "
                    f"{served.fingerprint}. Brakes closed, FCI off."
                )
            stack.enter_context(realtime_interpreter())
            granted = request_realtime_priority()
            spoken = sorted(one.version for one in features.protocols)
            versions = " to ".join(map(str, dict.fromkeys((spoken[0], spoken[-1]))))
            self.tell(
                f"Franka Control Interface {versions} of arm '{arm_id}' at "
                f"{host} ({granted})"
            )
            started = time.monotonic()
            try:
                server.run(is_over)
            finally:
                counts, duration = server.counts, time.monotonic() - started
                self.tell(
                    f"{counts.cycles} cycles in {duration:.1f} s; {counts.commanded} "
                    f"of them commanded by clients, {counts.lost} commands lost"
                )
        return server.counts


def features_of(
    parameters: FrankaParameters, version: int | None, warn: Callable[[str], None]
) -> ClientFeatures:
    """Return the versions and the models of an arm for clients.

    Args:
        parameters: The arm.
        version: The only version of the protocol; None for all versions with a table.
        warn: Called with a line if there is no model library for clients.

    Raises:
        RobotDescriptionError: The URDF of the arm cannot be used.
    """
    description = load_arm_description(parameters.robot_description, parameters.limits)
    libraries: Mapping[tuple[int, int], bytes] = {}
    try:
        libraries = build_model_library(description)
    except ModelLibraryError as error:
        warn(f"Clients get no model library: {error} {error.remedy}")
    model = write_robot_model(description, parameters.limits, parameters.arm)
    return ClientFeatures(protocols_of(parameters.arm, version), libraries, model)
