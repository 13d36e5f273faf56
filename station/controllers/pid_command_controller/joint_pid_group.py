"""One PID per joint, and its gains as run-time parameters."""

from collections.abc import Mapping
from dataclasses import replace
from math import isfinite

from station.controllers.forward_command_controller import JointQuantity
from station.core.control.tunables import Tunable, Tunables
from station.core.declared_parameter import EACH_JOINT, DeclaredParameter
from station.core.description.robot_description import JointDescription
from station.core.errors import InvalidGainError, ParameterError
from station.core.numerics.pid import PID_PARAMETERS, PidGains, apply_gains
from station.core.numerics.pid_group import PidGroup
from station.core.parameters import Parameters
from station.memory.doubles import Doubles, Storage, own_zeros, zeros

GAIN_MAXIMUM = 10_000.0
"""Largest `p` and `i` offered for tuning, in the units of the gain."""
DERIVATIVE_GAIN_MAXIMUM = 1_000.0
"""Largest `d` offered for tuning, in the unit of the gain."""
CLAMP_MAXIMUM = 1_000.0
"""Largest bound of the integral part offered for tuning, in the command's unit."""

_DESCRIPTIONS = {
    "p": "proportional gain",
    "i": "integral gain",
    "d": "derivative gain",
    "i_clamp_max": "upper bound of the integral part",
    "i_clamp_min": "lower bound of the integral part",
}


class JointPidGroup:
    """The PIDs of a controller, in the order of its joints.

    Args:
        joints: The joints.
        gains: First gains, in the same order.
        error: The quantity whose error the PIDs reduce.
        command: The quantity that the PIDs compute.
        commands: Where the commands are written, shape (n,); None for new memory.
        errors: Where the errors are found, shape (n,); None for new memory.
        rates: Where the rates of the errors are found, shape (n,); None for new memory.

    Attributes:
        errors: Set-points minus measured values, in the unit of the error, shape (n,);
            the controller writes them.
        rates: Rates of the errors, in the unit of the error per second, shape (n,);
            written by the controller where they are known.
        commands: The commands, shape (n,).
        group: The PIDs.
        tunables: The gains as run-time parameters, named `<joint>/p`, `/i`, `/d`,
            `/i_clamp_max` and `/i_clamp_min`. A change keeps errors and the integral
            part of the command, as far as the new bounds allow it.
    """

    def __init__(
        self,
        joints: list[JointDescription],
        gains: list[PidGains],
        *,
        error: JointQuantity,
        command: JointQuantity,
        commands: Doubles | None = None,
        errors: Doubles | None = None,
        rates: Storage | None = None,
    ) -> None:
        size = len(joints)
        self._names = [joint.name for joint in joints]
        self.errors = zeros(size) if errors is None else errors
        self.rates: Storage = own_zeros(size) if rates is None else rates
        self.commands = zeros(size) if commands is None else commands
        self.group = PidGroup(self.errors, self.rates, self.commands)
        self._gains: list[PidGains] = []
        self._use(gains)
        schema: dict[str, Tunable] = {}
        values: dict[str, float] = {}
        for joint, each in zip(joints, gains, strict=True):
            units = _units(command.unit(joint), error.unit(joint))
            for key, value in _named(each).items():
                schema[f"{joint.name}/{key}"] = _tunable(key, value, units[key])
                values[f"{joint.name}/{key}"] = value
        self.tunables = Tunables(
            schema,
            values,
            check=self._check_bounds,
            apply=self._set_gains,
            notes=self._without_effect,
        )

    def reset(self) -> None:
        """Forget all errors and integrals."""
        self.group.reset()

    def columns(self) -> dict[str, list[float] | list[bool]]:
        """Return the gains in force by their name in JointControllerState, (n,) each.

        Source:
            control_msgs@1.5.2 msg/JointControllerState.msg.
        """
        gains = self._gains
        return {
            "p": [each.p for each in gains],
            "i": [each.i for each in gains],
            "d": [each.d for each in gains],
            "i_clamp": [each.i_max for each in gains],
            "antiwindup": [each.antiwindup for each in gains],
        }

    def _check_bounds(self, values: Mapping[str, float]) -> None:
        for name in self._names:
            lower = values[f"{name}/i_clamp_min"]
            upper = values[f"{name}/i_clamp_max"]
            if lower > upper:
                raise InvalidGainError(
                    f"Gain '{name}/i_clamp_min' is {lower}, above "
                    f"'{name}/i_clamp_max', which is {upper}.",
                    remedy="Send bounds with i_clamp_min <= i_clamp_max.",
                )

    def _without_effect(self, values: Mapping[str, float]) -> list[str]:
        return [
            f"The gain '{name}/i' is {values[f'{name}/i']:g} and has no effect: the "
            "integral part is bounded by 'i_clamp', which is 0. Give i_clamp, the "
            "largest integral part of the command."
            for name in self._names
            if values[f"{name}/i"] != 0.0
            and values[f"{name}/i_clamp_min"] == values[f"{name}/i_clamp_max"] == 0.0
        ]

    def _set_gains(self, values: Mapping[str, float]) -> None:
        gains = [
            PidGains(
                p=values[f"{name}/p"],
                i=values[f"{name}/i"],
                d=values[f"{name}/d"],
                i_max=values[f"{name}/i_clamp_max"],
                i_min=values[f"{name}/i_clamp_min"],
                antiwindup=before.antiwindup,
            )
            for name, before in zip(self._names, self._gains, strict=True)
        ]
        for index, (before, after) in enumerate(zip(self._gains, gains, strict=True)):
            self._keep_integral_part(index, before, after)
        self._use(gains)

    def _keep_integral_part(
        self, index: int, before: PidGains, after: PidGains
    ) -> None:
        """Let the integral part of one joint's command go on from where it is.

        The integral part often carries a load. If the integral itself stayed, twice the
        gain would be twice the torque in the next cycle.
        """
        same = (before.i, before.i_min, before.i_max) == (
            after.i,
            after.i_min,
            after.i_max,
        )
        if same or after.i == 0.0:
            return
        part = before.i * self.group.integral(index)
        part = max(before.i_min, min(before.i_max, part))
        integral = part / after.i
        # The smallest gains would need an integral beyond the largest float.
        self.group.set_integral(index, integral if isfinite(integral) else 0.0)

    def _use(self, gains: list[PidGains]) -> None:
        for index, each in enumerate(gains):
            apply_gains(self.group, index, each)
        self._gains = gains


def pid_parameters(
    *, error: JointQuantity, command: JointQuantity
) -> tuple[DeclaredParameter, ...]:
    """Return the declarations of what `read_pid_gains` reads, at its first place.

    Args:
        error: The quantity whose error the PIDs reduce.
        command: The quantity that the PIDs compute.
    """
    rotating = JointDescription("")
    units = _units(command.unit(rotating), error.unit(rotating))
    units["i_clamp"] = command.unit(rotating)
    return tuple(
        replace(each.inside(f"{EACH_JOINT}/pid"), unit=units.get(each.name, ""))
        for each in PID_PARAMETERS
    )


def read_pid_gains(
    params: Parameters, joints: list[JointDescription]
) -> list[PidGains]:
    """Read the gains of every joint from any of the places where ROS files have them.

    These are `<joint>/pid`, `<joint>`, `gains/<joint>`, and `pid` for a controller of
    one joint. Each holds `p`, `i`, `d`, `i_clamp` (or `i_clamp_min` and `i_clamp_max`)
    and `antiwindup`.

    Args:
        params: The controller's namespace.
        joints: The joints, in the order of the result.

    Raises:
        ParameterError: A joint has no gains, or its gains are not allowed.
    """
    return [
        _read_gains(params, joint.name, is_only=len(joints) == 1) for joint in joints
    ]


def _read_gains(params: Parameters, joint: str, *, is_only: bool) -> PidGains:
    places = [f"{joint}/pid", joint, f"gains/{joint}"] + (["pid"] if is_only else [])
    for place in places:
        if params.has(f"{place}/p") or params.has(f"{place}/pid/p"):
            return PidGains.from_parameters(params.namespace(place))
    raise ParameterError(
        f"Parameter '{params.resolve(f'{places[0]}/p')}' is missing.",
        remedy=f"Give the gains of joint '{joint}' as '{places[0]}: {{p, i, d}}'.",
        details={"parameter": params.resolve(f"{places[0]}/p")},
    )


def _named(gains: PidGains) -> dict[str, float]:
    return {
        "p": gains.p,
        "i": gains.i,
        "d": gains.d,
        "i_clamp_max": gains.i_max,
        "i_clamp_min": gains.i_min
        + 0.0,  # turns -0.0, which would be printed, into 0.0
    }


def _units(command: str, error: str) -> dict[str, str]:
    """Return the unit of every gain, e.g. Nm/rad, Nm/(rad s), Nm s/rad."""
    base, per_second = (error[:-2], True) if error.endswith("/s") else (error, False)
    proportional = f"{command} s/{base}" if per_second else f"{command}/{base}"
    integral = f"{command}/{base}" if per_second else f"{command}/({base} s)"
    derivative = f"{command} s^2/{base}" if per_second else f"{command} s/{base}"
    units = {"p": proportional, "i": integral, "d": derivative}
    if command == f"{error}/s":
        units = {"p": "1/s", "i": "1/s^2", "d": ""}
    return {**units, "i_clamp_max": command, "i_clamp_min": command}


def _tunable(key: str, value: float, unit: str) -> Tunable:
    """Return unit and range of a gain; the range includes the configured value."""
    maximum = {"p": GAIN_MAXIMUM, "i": GAIN_MAXIMUM, "d": DERIVATIVE_GAIN_MAXIMUM}
    upper = maximum.get(key, CLAMP_MAXIMUM)
    lower = 0.0
    if key == "i_clamp_min":
        lower, upper = -upper, 0.0
    return Tunable(unit, min(lower, value), max(upper, value), _DESCRIPTIONS[key])
