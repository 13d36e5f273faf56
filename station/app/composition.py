"""Build the robot, parameters, manager, loop and facade of a configured station."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from station.config import StationConfig
from station.config.loading import RESERVED_NAMES
from station.controllers import CONTROLLERS
from station.core.clock import Clock, SystemClock
from station.core.control.controller_loader import default_loaders
from station.core.control.controller_manager import (
    CONTROLLER_MANAGER,
    ControllerManager,
)
from station.core.control.hardware_components import INITIAL_STATE
from station.core.errors import ConfigError, StationError, show
from station.core.facade.station import Station
from station.core.hardware.async_robot_hw import AsyncRobotHW
from station.core.loop.control_loop import ControlLoop
from station.core.loop.heartbeat import Heartbeat
from station.core.loop.snapshot import SnapshotRing
from station.core.parameters import Parameters, ParameterTree
from station.hw.robot_loader import create_robot

ROBOT_NAMESPACE = "robot"
SCENE_NAMESPACE = "scene"
_UPDATE_RATE = "update_rate"


@dataclass(frozen=True, slots=True)
class Composition:
    """The parts of a station that need no network.

    Attributes:
        station: The facade; it knows the loop, the manager and the parameters.
        not_loaded: Errors that kept controllers of the configuration from loading, by
            controller.
    """

    station: Station
    not_loaded: dict[str, StationError]

    def sort_starts(self, names: Sequence[str]) -> tuple[list[str], list[str]]:
        """Return the controllers that can start, and a warning for each of the others.

        A controller whose hardware is configured to begin inactive does not prevent the
        whole start.

        Args:
            names: Names of controllers to start.
        """
        lifecycle = self.station.manager.lifecycle
        refused = {
            name: reason
            for name in names
            if (reason := lifecycle.components.refusal(lifecycle.find(name).info))
        }
        return [name for name in names if name not in refused], [
            f"Controller '{name}' is not started: {reason}."
            for name, reason in refused.items()
        ]

    def warnings(self) -> list[str]:
        """Return warnings about the configured controllers, for the log."""
        missing = [
            f"Controller '{name}' is not loaded: {error} {error.remedy}"
            for name, error in self.not_loaded.items()
        ]
        notes = [
            f"Controller '{status.name}': {note}"
            for status in self.station.controllers()
            for note in status.notes
        ]
        return [*missing, *notes, *self._other_rate()]

    def _other_rate(self) -> list[str]:
        """Return a warning if a file of ROS 2 asks for another rate of the loop."""
        key = f"{CONTROLLER_MANAGER}/{_UPDATE_RATE}"
        wanted, rate = self.station.parameters.get(key), 1.0 / self.station.loop.period
        if wanted is None or wanted == round(rate, 6):
            return []
        return [
            f"The parameter '{_UPDATE_RATE}' of {CONTROLLER_MANAGER} is {show(wanted)} "
            f"and has no effect: the loop runs at {rate:g} Hz, the station.rate."
        ]


def compose(
    config: StationConfig,
    clock: Clock | None = None,
    *,
    heartbeat: Heartbeat | None = None,
    snapshots: SnapshotRing | None = None,
    announce: Callable[[str], None] = lambda _: None,
) -> Composition:
    """Build everything up to the facade and load the controllers; nothing runs yet.

    A controller that cannot be loaded is an error if it is to be started, and is
    otherwise left out, so that parameter files may name unknown types.

    Args:
        config: The configuration.
        clock: Clock of wall time; None for the system's clock.
        heartbeat: The page that the loop shares with a watchdog, if there is one.
        snapshots: Ring that receives the snapshots; None makes one of the usual size. A
            smaller one saves memory where many stations share a process.
        announce: Called with the name of each step before it begins, because the start
            of a robot or of a controller may take long, or hang.

    Raises:
        StationError: The robot, or a controller to be started, cannot be used.
    """
    clock = clock or SystemClock()
    root = root_parameters(config)
    initial = config.station.hardware_components_initial_state
    if initial:
        root.set(f"{CONTROLLER_MANAGER}/{INITIAL_STATE}", dict(initial))
    announce(f"Building the robot {config.robot.type}")
    params = root.namespace(ROBOT_NAMESPACE)
    robot = AsyncRobotHW.wrap(create_robot(config.robot.type), params)
    robot.init(root, params)
    robot.check_period(1.0 / config.station.rate)
    loaders = default_loaders(CONTROLLERS, config.controller_modules())
    manager = ControllerManager(robot, root, loaders, clock)
    loop = ControlLoop(
        robot,
        manager,
        clock=clock,
        period=1.0 / config.station.rate,
        real_time_factor=config.station.real_time_factor,
        update_budget=config.station.longest_update(),
        snapshots=snapshots,
        heartbeat=heartbeat,
    )
    station = Station(
        loop,
        manager,
        root,
        config.robot.type,
        reserved=RESERVED_NAMES,
        # Other parameters must not replace the robot's; the robot description may
        # change, because models that are loaded later read it.
        fixed=frozenset({ROBOT_NAMESPACE}),
    )
    _check_envelope(config, station.joint_names)
    return Composition(station, _load_controllers(station, config, announce))


def root_parameters(config: StationConfig) -> Parameters:
    """Return the parameters in the root namespace of a configured station."""
    return Parameters(
        ParameterTree({
            **config.parameters,
            ROBOT_NAMESPACE: config.robot_parameters(),
            SCENE_NAMESPACE: config.scene.model_dump(exclude_none=True),
            **config.controller_parameters(),
        })
    )


def _check_envelope(config: StationConfig, joints: Sequence[str]) -> None:
    # A range for a misspelt joint would have no effect.
    unknown = sorted(config.agents.envelope.joints.keys() - set(joints))
    if unknown:
        raise ConfigError(
            [f"agents.envelope.joints names {unknown}; the robot has {list(joints)}."],
            remedy="Correct the configuration and start again.",
        )


def _load_controllers(
    station: Station, config: StationConfig, announce: Callable[[str], None]
) -> dict[str, StationError]:
    failed: dict[str, StationError] = {}
    waiting, rounds_left = [*config.controllers], len(config.controllers)
    while waiting:
        rounds_left -= 1
        later: list[str] = []
        for name in waiting:
            announce(f"Loading the controller '{name}'")
            try:
                station.load_controller(name, strict=name not in config.ros_controllers)
            except StationError as error:
                # It may claim a reference of a controller that the file has below it.
                owner = str(error.details.get("resource", "")).partition("/")[0]
                if owner in waiting and owner != name and rounds_left > 0:
                    later.append(name)
                elif name in config.start:
                    raise
                else:
                    failed[name] = error
        waiting = later
    return failed
