"""Turn errors into commands: proportional, integral and derivative part.

With `error = target - measured value`:

| quantity         | formula                                                          |
|------------------|------------------------------------------------------------------|
| rate             | `(error - last error) / period`; the last error is 0 at first    |
|                  | and after `reset`; in the first cycle after `reset_to` the given |
|                  | rate is used                                                     |
| integral         | `integral += period * error`                                     |
| with antiwindup  | the integral is kept between `i_min / i` and `i_max / i`         |
|                  | if i != 0                                                        |
| i term           | `i * integral`; without antiwindup kept from `i_min` to `i_max`  |
| command          | `p * error + i term + d * rate`; then                            |
|                  | `rate gain * desired rate` is added, see `feed_forward`          |

Source: control_toolbox@de05a5c src/pid.cpp, Pid.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite, isnan

from station.core.declared_parameter import (
    DeclaredParameter,
    declare_boolean,
    declare_number,
)
from station.core.errors import InvalidGainError, ParameterError
from station.core.parameters import Parameters
from station.memory.doubles import Doubles, Storage, own_zeros, zeros

NO_ERROR = 1
"""Bit for a period of 0 or an error that is not finite."""
NO_RATE = 2
"""Bit for a rate that is not finite."""


def _declare(
    name: str, unit: str, description: str, default_text: str = ""
) -> DeclaredParameter:
    return declare_number(
        name,
        description,
        None if default_text or name == "p" else 0.0,
        unit,
        default_text=default_text,
    )


_P = _declare("p", "command/error", "proportional gain")
_I = _declare("i", "command/(error s)", "integral gain")
_D = _declare("d", "command s/error", "derivative gain")
_CLAMP = _declare("i_clamp", "command", "bound of the integral part")
_CLAMP_MAX = _declare(
    "i_clamp_max", "command", "upper bound of the integral part", "i_clamp"
)
_CLAMP_MIN = _declare(
    "i_clamp_min", "command", "lower bound of the integral part", "-i_clamp"
)
_ANTIWINDUP = declare_boolean(
    "antiwindup",
    "bound the integral itself, not only its part of the command",
    default=False,
)
PID_PARAMETERS = (_P, _I, _D, _CLAMP, _CLAMP_MAX, _CLAMP_MIN, _ANTIWINDUP)
"""The parameters of a set of gains, in the namespace of the gains."""


@dataclass(frozen=True, slots=True)
class PidGains:
    """One consistent set of gains.

    Attributes:
        p: Proportional gain [command unit / error unit].
        i: Integral gain [command unit / (error unit * s)].
        d: Derivative gain [command unit * s / error unit].
        i_max: Largest integral part of the command; inf for no bound.
        i_min: Smallest integral part of the command; -inf for no bound.
        antiwindup: True bounds the integral itself, so that it cannot grow while the
            integral part is cut off; False bounds only the integral part.

    Raises:
        InvalidGainError: A gain is not finite, or the bounds are NaN or inverted.

    Source:
        control_toolbox@de05a5c pid.h, Pid::Gains; differs: inverted bounds and gains
        that are not finite are refused; they are undefined behaviour in the original.
    """

    p: float = 0.0
    i: float = 0.0
    d: float = 0.0
    i_max: float = 0.0
    i_min: float = -0.0
    antiwindup: bool = False

    def __post_init__(self) -> None:
        for name, gain in (("p", self.p), ("i", self.i), ("d", self.d)):
            if not isfinite(gain):
                raise InvalidGainError(
                    f"PID gain {name} is {gain}; allowed are finite numbers.",
                    remedy=f"Give a finite number for {name}.",
                )
        if isnan(self.i_min) or isnan(self.i_max) or self.i_min > self.i_max:
            raise InvalidGainError(
                f"PID integral bounds are {self.i_min} to {self.i_max}; "
                "the lower one must not exceed the upper one.",
                remedy="Correct i_clamp, or i_clamp_min and i_clamp_max.",
            )

    @classmethod
    def from_parameters(cls, params: Parameters) -> "PidGains":
        """Read gains from a namespace of parameters.

        `p` is required; `i`, `d` and `i_clamp` are 0 and `antiwindup` is false if
        absent. `i_clamp_min` and `i_clamp_max` each replace one side of `i_clamp`;
        the signs of all three do not matter.

        Args:
            params: The namespace of the gains, or the one that holds it under the
                name `pid` or `gains`.

        Returns:
            The gains.

        Raises:
            ParameterError: `p` is missing, or a value has the wrong type.

        Source:
            control_toolbox@de05a5c src/pid.cpp, Pid::init; differs: a value of the
            wrong type is refused, not replaced by its default; `publish_state` has no
            effect.
        """
        where = params
        for name in ("pid", "gains"):
            if not where.has("p") and where.has(name):
                where = where.namespace(name)
        clamp = abs(_CLAMP.read_float(where))
        return cls(
            p=_P.read_float(where),
            i=_I.read_float(where),
            d=_D.read_float(where),
            i_max=abs(_CLAMP_MAX.read_float(where, clamp)),
            i_min=-abs(_CLAMP_MIN.read_float(where, clamp)),
            antiwindup=_ANTIWINDUP.read_bool(where),
        )

    @classmethod
    def of_joints(cls, params: Parameters, joints: Sequence[str]) -> "list[PidGains]":
        """Read the gains of every joint from the places where ROS files have them.

        The places are `<joint>/pid`, `<joint>`, `gains/<joint>`, and `pid` for a
        controller of one joint; see `from_parameters`.

        Args:
            params: The controller's namespace.
            joints: The joints, in the order of the result.

        Raises:
            ParameterError: A joint has no gains, or its gains are not allowed.
        """
        places = cls.places(params, joints)
        return [cls.from_parameters(params.namespace(place)) for place in places]

    @staticmethod
    def places(params: Parameters, joints: Sequence[str]) -> list[str]:
        """Return the namespace of the gains of every joint, e.g. `gains/joint1`.

        Args:
            params: The controller's namespace.
            joints: The joints, in the order of the result.

        Raises:
            ParameterError: A joint has no gains.
        """
        is_only = len(joints) == 1
        return [_find_gains(params, name, is_only=is_only) for name in joints]


def _find_gains(params: Parameters, joint: str, *, is_only: bool) -> str:
    places = [f"{joint}/pid", joint, f"gains/{joint}"]
    for place in places + (["pid"] if is_only else []):
        for inner in (place, f"{place}/pid"):
            if params.has(f"{inner}/p"):
                return inner
    raise ParameterError(
        f"Parameter '{params.resolve(f'{places[0]}/p')}' is missing.",
        remedy=f"Give the gains of joint '{joint}' as '{places[0]}: {{p, i, d}}'.",
        details={"parameter": params.resolve(f"{places[0]}/p")},
    )


class PidGroup:
    """The PIDs of n joints, which read errors and write commands in place.

    Args:
        errors: Targets minus measured values, shape (n,); the owner writes them.
        rates: Rates of the errors [1/s], shape (n,); written by the owner, or computed.
        commands: Receives the commands, shape (n,).
    """

    def __init__(self, errors: Storage, rates: Storage, commands: Storage) -> None:
        size = len(errors)
        self.n = size
        self.errors = errors
        self.rates = rates
        self.commands = commands
        self.integrals = own_zeros(size)
        # NaN stands for no last error.
        self.last = own_zeros(size)
        self.p = own_zeros(size)
        self.i = own_zeros(size)
        self.d = own_zeros(size)
        self.i_max = own_zeros(size)
        self.i_min = own_zeros(size)
        # Not 0 where antiwindup is on.
        self.antiwindup = own_zeros(size)
        self.feeds_forward = False
        self.desired_rates = rates
        self.rate_gains = rates

    def feed_forward(self, rates: Doubles, gains: Doubles) -> None:
        """Add desired rates times gains to all commands from now on.

        Args:
            rates: Desired rates, shape (n,); the owner writes them.
            gains: Gains of the rates, shape (n,).
        """
        self.feeds_forward = any(gains)
        self.desired_rates, self.rate_gains = rates, gains

    def set_gains(self, k: int, gains: PidGains) -> None:
        """Set the gains of joint `k`; its error and integral stay."""
        self.p[k], self.i[k], self.d[k] = gains.p, gains.i, gains.d
        self.i_max[k], self.i_min[k] = gains.i_max, gains.i_min
        self.antiwindup[k] = 1.0 if gains.antiwindup else 0.0

    def reset(self) -> None:
        """Forget all errors; the next rates are computed from errors of 0."""
        for k in range(self.n):
            self.reset_to(k, 0.0, 0.0)
            self.last[k] = 0.0

    def reset_to(self, k: int, rate: float, integral: float) -> None:
        """Forget the last error of joint `k`, and set its rate and integral.

        Args:
            k: Index of the joint.
            rate: Rate of the error that the next `compute_commands` uses [1/s].
            integral: Integral of the error [s].
        """
        self.rates[k] = rate
        self.integrals[k] = integral
        self.last[k] = float("nan")

    def integral(self, k: int) -> float:
        """Return the integral of the error of joint `k` [s]."""
        return self.integrals[k]

    def set_integral(self, k: int, integral: float) -> None:
        """Set the integral of the error of joint `k` [s]; its last error stays."""
        self.integrals[k] = integral

    def compute_commands(self, period: float, rates_known: bool) -> int:  # noqa: FBT001
        """Compute the commands from the errors.

        The command of a joint is 0, and its integral stays, when the period is 0, or
        its error or rate is not finite.

        Args:
            period: Time since the last computation [s].
            rates_known: Whether the owner has written the rates of the errors;
                otherwise they follow from the last errors, and stay when the period is
                0 or an error is not finite.

        Returns:
            0 when all commands were computed; otherwise 1 for a period of 0 or an error
            that is not finite, plus 2 for a rate that is not finite.
        """
        errors, rates, commands = self.errors, self.rates, self.commands
        integrals, last = self.integrals, self.last
        p, i, d = self.p, self.i, self.d
        i_max, i_min, antiwindup = self.i_max, self.i_min, self.antiwindup
        stands = period == 0.0
        differentiates = not rates_known and period > 0.0
        mask = 0
        for k in range(self.n):
            error = errors[k]
            # Only the difference of a finite number to itself is 0.
            if stands or error - error != 0.0:
                commands[k] = 0.0
                mask |= NO_ERROR
                continue
            rate = rates[k]
            if differentiates:
                before = last[k]
                last[k] = error
                if before == before:
                    rate = (error - before) / period
                rates[k] = rate
            if rate - rate != 0.0:
                commands[k] = 0.0
                mask |= NO_RATE
                continue
            gain = i[k]
            integral = integrals[k] + period * error
            if antiwindup[k] != 0.0:
                if gain != 0.0:
                    low = i_min[k] / gain
                    high = i_max[k] / gain
                    if high < low:
                        low, high = high, low
                    if integral < low:
                        integral = low
                    elif high < integral:
                        integral = high
                part = gain * integral
            else:
                part = gain * integral
                if part < i_min[k]:
                    part = i_min[k]
                elif i_max[k] < part:
                    part = i_max[k]
            integrals[k] = integral
            commands[k] = p[k] * error + part + d[k] * rate
        if self.feeds_forward:
            for k in range(self.n):
                commands[k] = self.rate_gains[k] * self.desired_rates[k] + commands[k]
        return mask


class Pid:
    """Compute a command from an error once per cycle.

    The control thread computes and resets. Any thread may set the gains: they are one
    immutable object that is exchanged as a whole, so that a cycle uses a single set.
    """

    def __init__(self, gains: PidGains | None = None) -> None:
        """Start with no error and no integral.

        Args:
            gains: First gains; None for zeros.
        """
        self._gains: PidGains = gains if gains is not None else PidGains()
        self._error, self._rate, self._output = zeros(1), zeros(1), zeros(1)
        self._group = PidGroup(self._error, self._rate, self._output)
        self._p_error: float = 0.0
        self._command: float = 0.0
        self._applied: PidGains | None = None

    @classmethod
    def from_parameters(cls, params: Parameters) -> "Pid":
        """Return a controller with the gains of a namespace of parameters.

        Args:
            params: See `PidGains.from_parameters`.

        Returns:
            A controller with no error and no integral.

        Raises:
            ParameterError: See `PidGains.from_parameters`.
        """
        return cls(PidGains.from_parameters(params))

    @property
    def gains(self) -> PidGains:
        """The gains in use."""
        return self._gains

    def set_gains(self, gains: PidGains) -> None:
        """Replace all gains at once; errors and integral stay. Any thread.

        Args:
            gains: Gains from the next computation on.
        """
        self._gains = gains

    def copy(self) -> "Pid":
        """Return a controller with the same gains, and no error and no integral."""
        return Pid(self._gains)

    def compute_command(self, error: float, period: float) -> float:
        """Return the command for an error; its rate follows from the last error.

        Args:
            error: Target minus measured value.
            period: Time since the last computation [s]. A period of 0, or an error that
                is not finite, gives the command 0 and changes nothing.

        Returns:
            The command; 0 if none can be computed.
        """
        group = self._prepared(error)
        missing = group.compute_commands(period, rates_known=False)
        if missing != NO_ERROR:
            self._p_error = error
        if not missing:
            self._command = self._output[0]
        return self._output[0]

    def compute_command_with_rate(
        self, error: float, error_dot: float, period: float
    ) -> float:
        """Return the command for an error and its measured rate.

        Args:
            error: Target minus measured value.
            error_dot: Rate of the error [1/s].
            period: Time since the last computation [s]. A period of 0, or an error or
                rate that is not finite, gives the command 0; the errors are kept.

        Returns:
            The command; 0 if none can be computed.
        """
        self._p_error = error
        self._rate[0] = error_dot
        if not self._prepared(error).compute_commands(period, rates_known=True):
            self._command = self._output[0]
        return self._output[0]

    def _prepared(self, error: float) -> PidGroup:
        """Return the group of this one PID, with its error and its newest gains."""
        gains = self._gains
        if gains is not self._applied:
            self._group.set_gains(0, gains)
            self._applied = gains
        self._error[0] = error
        return self._group

    def get_current_command(self) -> float:
        """Return the command computed or set last."""
        return self._command

    def set_current_command(self, command: float) -> None:
        """Replace the current command by one that was computed elsewhere.

        Args:
            command: The command that `get_current_command` then returns.
        """
        self._command = command

    def get_current_pid_errors(self) -> tuple[float, float, float]:
        """Return error, integral of the error [s], and rate of the error [1/s]."""
        return (self._p_error, self._group.integral(0), self._rate[0])

    def reset(self) -> None:
        """Forget all errors; the next rate is computed from an error of 0."""
        self._p_error = self._command = 0.0
        self._group.reset()

    def reset_to(self, d_error: float, i_error: float) -> None:
        """Forget the last error, and start from a known rate and integral.

        Args:
            d_error: Rate of the error that the next computation uses [1/s].
            i_error: Integral of the error [s].
        """
        self._p_error = self._command = 0.0
        self._group.reset_to(0, d_error, i_error)
