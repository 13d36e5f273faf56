"""Stations as Gymnasium environments: `gymnasium.make("station.gym:Station-v0")`.

Importing this module registers the environment; it needs the extra `gym`. The actions
are set-points of a controller.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, Literal, SupportsFloat, TypeAlias, cast

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray
from typing_extensions import override

from station.app.in_process import InProcessStation
from station.core.errors import InvalidCommandError, ParameterError, show
from station.core.hardware.limits import JointLimits
from station.core.hardware.robot_report import JointLimitsReport
from station.core.ports.set_point import SetPointElement

Array: TypeAlias = NDArray[np.float64] | NDArray[np.float32]
Precision: TypeAlias = Literal["float64", "float32"]
Observation: TypeAlias = dict[str, Array]
Reward: TypeAlias = Callable[[Observation, Array], float]
Ended: TypeAlias = Callable[[Observation], bool]

_WIDEST = 1e6
"""Bound of set-points, velocities and efforts that have no limit of their own."""
_QUATERNION = {"qx", "qy", "qz", "qw"}
_VECTORS = {"vx", "vy", "vz", "wx", "wy", "wz"}
"""Elements of velocity vectors, three each, whose length is limited."""


class StationEnv(gymnasium.Env[Observation, Array]):
    """A simulated robot of a station that runs as fast as the processor can.

    An action is a set-point of one controller, in its units. A number beyond the range
    is clipped to the range, as Gymnasium's own environments do; a number that is not
    finite is refused. The controller limits, filters and checks the action like every
    set-point. The quaternion of a pose is scaled to length 1.

    An observation has `position` [rad or m], `velocity` and `effort` of all joints,
    shape (n,) each. The space has the joints' limits as bounds, and 1e6 where a joint
    has none. Values beyond the bounds, e.g. after a fault, are clipped, so that every
    observation is within the space; `station` has the values as they are. An episode
    terminates when the robot or the controller stops with a fault (`info["fault"]` says
    why) or when `terminated` returns True. It is truncated after `seconds`.

    `reset(options={"joint_positions": {"panda_joint1": 0.3}})` begins at other
    positions. The same seed and the same actions give the same trajectory, bit for bit.

    Args:
        config: As for `station.open`.
        controller: The controller that takes the actions; any controller with
            set-points.
        cycles_per_step: Number of control cycles per action, >= 1. A streaming or jog
            controller brakes when these cycles take longer than its `command_timeout`.
        seconds: Longest episode [s station time].
        reward: Function that returns the reward for an observation and the action
            before it; None gives the reward 0.
        terminated: Function that returns whether the task is over, for an observation;
            None never ends it.
        noise: Standard deviation of the initial joint positions [rad or m], >= 0.
        settings: As for `station.open`.
        dtype: Type of actions and observations, `float64` or `float32`.

    Attributes:
        station: The station, for operations that the environment does not offer.

    Raises:
        ParameterError: `dtype` is neither of the two.
        StationError: The controller takes no set-points, or the robot is not simulated.
    """

    metadata: dict[str, Any] = {"render_modes": []}  # noqa: RUF012 - gymnasium's name

    def __init__(  # noqa: PLR0913 - all but one by keyword, as gymnasium.make hands on
        self,
        config: Path | str | Mapping[str, object] | None = None,
        *,
        controller: str = "position_streaming_controller",
        cycles_per_step: int = 20,
        seconds: float = 5.0,
        reward: Reward | None = None,
        terminated: Ended | None = None,
        noise: float = 0.0,
        settings: Mapping[str, object] | None = None,
        dtype: Precision = "float64",
    ) -> None:
        if dtype not in {"float64", "float32"}:
            raise ParameterError(
                f"dtype is {show(dtype)}; it must be float64 or float32.",
                remedy="Choose one of them.",
            )
        self._dtype = np.dtype(dtype)
        self.station = InProcessStation(config, settings=settings)
        self.render_mode = None
        facade = self.station.facade
        elements = facade.motion.set_point(controller).elements
        facade.simulation.report()  # refuses a robot that is not simulated
        self._controller = controller
        self._cycles = cycles_per_step
        self._seconds = seconds
        self._reward = reward
        self._terminated = terminated
        self._noise = noise
        self._begin = 0
        names = [element.name for element in elements]
        self._quaternion = [i for i, name in enumerate(names) if name in _QUATERNION]
        self._low, self._high = _action_bounds(elements)
        self.action_space = cast(
            "spaces.Space[Array]", self._box(self._low, self._high)
        )
        self._bounds = _observation_bounds(
            self.station.joint_names, facade.loop.hw.joint_limits()
        )
        boxes = {name: self._box(*bounds) for name, bounds in self._bounds.items()}
        self.observation_space = cast(
            "spaces.Space[Observation]", spaces.Dict({**boxes})
        )

    @override
    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Put the robot back to its start and begin an episode.

        Args:
            seed: Seed of the noise.
            options: `joint_positions`, position by joint [rad or m].

        Returns:
            The first observation, and `info` with `time` [s] and `fault`.
        """
        super().reset(seed=seed)
        station, facade = self.station, self.station.facade
        running = [c.name for c in facade.controllers() if c.state.value == "running"]
        if self._controller in running:
            station.switch(stop=[self._controller])
        facade.robots.recover_all()
        station.reset()
        wanted = dict((options or {}).get("joint_positions", {}))
        if self._noise:
            for name, position in station.positions().items():
                draw = self._noise * self.np_random.standard_normal()
                wanted.setdefault(name, self._within(name, position + draw))
        if wanted:
            station.reset(wanted)
        station.switch(start=[self._controller])
        self._begin = facade.loop.cycle
        return self._observe(), self._info(None)

    @override
    def step(
        self, action: Array
    ) -> tuple[Observation, SupportsFloat, bool, bool, dict[str, Any]]:
        """Give the controller a set-point and run some cycles.

        Args:
            action: The set-point, shape (k,); clipped to `action_space`.

        Returns:
            Observation, reward, whether the episode has terminated, whether it is
            truncated, and `info` with `time` [s] and `fault`.

        Raises:
            InvalidCommandError: The action is not finite, or has another shape.
        """
        action = self._within_space(action)
        fault = self._fault()
        if fault is None:
            self.station.command(self._controller, self._set_point(action))
        self.station.step(self._cycles)
        fault = fault or self._fault()
        observation = self._observe()
        reward = 0.0 if self._reward is None else self._reward(observation, action)
        is_over = fault is not None
        if self._terminated is not None:
            is_over = is_over or self._terminated(observation)
        is_late = self._time() >= self._seconds - 1e-9
        return observation, reward, is_over, is_late, self._info(fault)

    @override
    def close(self) -> None:
        """Stop the robot."""
        self.station.close()

    def _box(self, low: Array, high: Array) -> spaces.Box:
        kind = np.float32 if self._dtype == np.float32 else np.float64
        return spaces.Box(low.astype(kind), high.astype(kind), dtype=kind)

    def _within_space(self, action: Array) -> Array:
        """Return an action clipped to the range of the set-points.

        Raises:
            InvalidCommandError: The action is not finite, or has another shape.
        """
        values = np.asarray(action)
        if values.shape != self._low.shape or not np.isfinite(values).all():
            raise InvalidCommandError(
                f"The action is {show(values.tolist())}; '{self._controller}' takes "
                f"{len(self._low)} finite numbers, shape {self._low.shape}.",
                remedy="Take the shape of action_space.",
            )
        # Use the exact bounds: those of the space may be rounded up to `dtype`.
        clipped: Array = np.clip(values, self._low, self._high)
        return clipped

    def _set_point(self, action: Array) -> list[float]:
        """Return the action, with its quaternion scaled to length 1 if it has one."""
        values = [float(value) for value in action]
        if len(self._quaternion) == len(_QUATERNION):
            length = math.hypot(*(values[i] for i in self._quaternion))
            for i in self._quaternion:
                values[i] /= length or math.nan
        return values

    def _fault(self) -> str | None:
        """Return the fault that stopped the controller; None while it runs."""
        status = self.station.facade.controller(self._controller)
        if status.state.value == "running":
            return None
        return status.fault or f"The controller is {status.state.value}."

    def _observe(self) -> Observation:
        latest = self.station.latest()
        measured = {
            "position": latest.position,
            "velocity": latest.velocity,
            "effort": latest.effort,
        }
        return {
            name: np.clip(values, *self._bounds[name]).astype(self._dtype)
            for name, values in measured.items()
        }

    def _info(self, fault: str | None) -> dict[str, Any]:
        info: dict[str, Any] = {"time": self._time()}
        return info if fault is None else {**info, "fault": fault}

    def _time(self) -> float:
        """Return the time since the episode began [s], counted in cycles."""
        loop = self.station.facade.loop
        return (loop.cycle - self._begin) * loop.period

    def _within(self, joint: str, position: float) -> float:
        """Return a position within the limits of a joint."""
        for report in self.station.facade.loop.hw.joint_limits():
            if report.joint == joint:
                limits = report.limits
                low, high = limits.min_position, limits.max_position
                low = -_WIDEST if low is None else low
                high = _WIDEST if high is None else high
                return min(max(position, low), high)
        return position


def _observation_bounds(
    joints: Sequence[str], reports: Sequence[JointLimitsReport]
) -> dict[str, tuple[Array, Array]]:
    """Return the lowest and highest values of each quantity, shape (n,) each."""
    limits = {report.joint: report.limits for report in reports}
    ends: dict[str, list[tuple[float, float]]] = {}
    for joint in joints:
        known = limits.get(joint, JointLimits())
        low, high = known.min_position, known.max_position
        speed, effort = known.max_velocity, known.max_effort
        for name, least, most in (
            ("position", low, high),
            ("velocity", None if speed is None else -speed, speed),
            ("effort", None if effort is None else -effort, effort),
        ):
            ends.setdefault(name, []).append((
                -_WIDEST if least is None else least,
                _WIDEST if most is None else most,
            ))
    columns = {name: np.array(pairs).T for name, pairs in ends.items()}
    return {name: (low, high) for name, (low, high) in columns.items()}


def _action_bounds(elements: tuple[SetPointElement, ...]) -> tuple[Array, Array]:
    """Return the lowest and highest set-point, shape (k,) each."""
    low = np.array([max(e.minimum, -_WIDEST) for e in elements])
    high = np.array([min(e.maximum, _WIDEST) for e in elements])
    # The limit is a ball, the space a box: a box inside of the ball has only allowed
    # velocities.
    inside = np.array([3.0**-0.5 if e.name in _VECTORS else 1.0 for e in elements])
    return low * inside, high * inside


gymnasium.register("Station-v0", entry_point="station.gym:StationEnv")
