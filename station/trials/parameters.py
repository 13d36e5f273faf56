"""The parameters of a trial: numbers with flat names, which fit into a table.

- `gains/CONTROLLER/GAIN`: value of a gain, e.g. `gains/arm/panda_joint1/p`, in the
  gain's own range;
- `scale/CONTROLLER/SUFFIX`: factor, >= 0, on all gains that end in `/SUFFIX`, e.g. `p`;
- `load`: unknown mass at the end of the arm, 0 to 100 kg;
- `friction`, `friction/JOINT`: Coulomb friction of all joints, or of one, 0 to 1000
  [Nm or N];
- `damping`, `damping/JOINT`: viscous damping of all joints, or of one, 0 to 1000 [Nm
  s/rad or N s/m];
- `delay`: how many cycles late the robot receives the commands of joints, 0 to 100;
- `noise/position`, `noise/velocity`: standard deviation of the noise of measured
  positions, 0 to 1 [rad or m], and velocities, 0 to 10 [rad/s or m/s].
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

from station.core.errors import suggest
from station.trials.errors import ImpossibleRangeError, UnknownParameterError

_RANGES = {
    "load": (0.0, 100.0),
    "friction": (0.0, 1000.0),
    "damping": (0.0, 1000.0),
    "delay": (0.0, 100.0),
    "noise/position": (0.0, 1.0),
    "noise/velocity": (0.0, 10.0),
}
"""Lowest and highest value of each parameter that is not a gain."""
_OF_JOINTS = ("friction", "damping")
_OF_GAINS = ("gains", "scale")


@dataclass(slots=True)
class Overrides:
    """The parameters of a trial, sorted by the part that they change.

    Attributes:
        gains: Values by controller and gain.
        scales: Factors by controller and suffix.
        load: Unknown mass [kg], >= 0.
        friction: Coulomb friction by joint; the name "" stands for all joints.
        damping: Viscous damping by joint; the name "" stands for all joints.
        delay: Delay of the commands in cycles, >= 0.
        position_noise: Standard deviation of measured positions [rad or m], >= 0.
        velocity_noise: Standard deviation of measured velocities [rad/s or m/s], >= 0.
    """

    gains: dict[str, dict[str, float]] = field(default_factory=dict)
    scales: dict[str, dict[str, float]] = field(default_factory=dict)
    load: float = 0.0
    friction: dict[str, float] = field(default_factory=dict)
    damping: dict[str, float] = field(default_factory=dict)
    delay: int = 0
    position_noise: float = 0.0
    velocity_noise: float = 0.0


def is_whole(name: str) -> bool:
    """Return whether the values of a parameter are whole numbers."""
    return name == "delay"


def sort_out(parameters: Mapping[str, float]) -> Overrides:
    """Return the parameters of a trial, sorted by the part that they change.

    Raises:
        UnknownParameterError: The parameter is unknown.
        ImpossibleRangeError: A value is not allowed.
    """
    found = Overrides()
    for name, value in parameters.items():
        kind, _, rest = name.partition("/")
        if kind in _OF_GAINS:
            _add_gain(found, name, value)
            continue
        check(name, value)
        if kind in _OF_JOINTS:
            getattr(found, kind)[rest] = value
    found.load = parameters.get("load", 0.0)
    found.delay = int(parameters.get("delay", 0.0))
    found.position_noise = parameters.get("noise/position", 0.0)
    found.velocity_noise = parameters.get("noise/velocity", 0.0)
    return found


def check(name: str, value: float) -> None:
    """Refuse an unknown parameter, or a value that is not allowed.

    Only the station knows names and ranges of gains and joints. It checks them when the
    trial begins.

    Raises:
        UnknownParameterError: The parameter is unknown.
        ImpossibleRangeError: The value is not allowed.
    """
    kind, _, rest = name.partition("/")
    if kind in _OF_GAINS:
        _split(name)
        low, high = (
            (0.0, float("inf")) if kind == "scale" else (-float("inf"), float("inf"))
        )
    else:
        known = name if name in _RANGES else kind
        if known not in _RANGES or (rest and known == kind and kind not in _OF_JOINTS):
            names = [*_RANGES, "gains/CONTROLLER/GAIN", "scale/CONTROLLER/SUFFIX"]
            raise UnknownParameterError(
                f"Trials have no parameter '{name}'.",
                remedy=suggest(name, names),
                details={"parameter": name},
            )
        low, high = _RANGES[known]
    if not low <= value <= high or (is_whole(name) and value != int(value)):
        whole = "whole numbers " if is_whole(name) else ""
        raise ImpossibleRangeError(
            f"Parameter '{name}' cannot be {value:g}; allowed are {whole}{low:g} to "
            f"{high:g}.",
            details={"parameter": name, "value": value},
        )


def _split(name: str) -> tuple[str, str]:
    """Return the controller and the gain in the name of a parameter.

    Raises:
        UnknownParameterError: The name is malformed.
    """
    controller, _, gain = name.partition("/")[2].partition("/")
    if not (controller and gain):
        raise UnknownParameterError(
            f"'{name}' names no gain.",
            remedy="Write gains/CONTROLLER/GAIN, such as gains/arm/panda_joint1/p, or "
            "scale/CONTROLLER/SUFFIX, such as scale/arm/p.",
            details={"parameter": name},
        )
    return controller, gain


def _add_gain(found: Overrides, name: str, value: float) -> None:
    check(name, value)
    controller, gain = _split(name)
    target = found.gains if name.startswith("gains/") else found.scales
    target.setdefault(controller, {})[gain] = value


def gains_under(
    wanted: Overrides, gains: Mapping[str, Mapping[str, float]]
) -> dict[str, dict[str, float]]:
    """Return the gains of all controllers with the changes of a trial.

    Args:
        wanted: Changed gains, and factors of gains.
        gains: The gains before the trial's changes, by controller and name.

    Raises:
        UnknownParameterError: No gain has that name or suffix.
    """
    found = {name: dict(values) for name, values in gains.items()}
    for controller, factors in wanted.scales.items():
        known = found.get(controller, {})
        for suffix, factor in factors.items():
            named = [gain for gain in known if gain.endswith(f"/{suffix}")]
            if not named:
                suffixes = {gain.rpartition("/")[2] for gain in known}
                raise UnknownParameterError(
                    f"No gain of '{controller}' ends in '/{suffix}'.",
                    remedy=suggest(suffix, sorted(suffixes)),
                    details={"controller": controller, "gain": suffix},
                )
            for gain in named:
                known[gain] *= factor
    for controller, values in wanted.gains.items():
        known = found.get(controller, {})
        for gain, value in values.items():
            if gain not in known:
                raise UnknownParameterError(
                    f"Controller '{controller}' has no gain '{gain}'.",
                    remedy=suggest(gain, known),
                    details={"controller": controller, "gain": gain},
                )
            known[gain] = value
    return found
