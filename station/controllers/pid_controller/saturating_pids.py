"""PIDs with bounded commands that keep their integral parts from winding up.

With the integral part I, the error e and the period dt:

    u = p e + I + d de/dt,  command = u between its bounds + forward

| strategy                  | integral part                                            |
|---------------------------|----------------------------------------------------------|
| `none`                    | I += i e dt after the command                            |
| `back_calculation`        | I += (i e + (command - u) / T) dt after the command      |
| `conditional_integration` | I += i e dt after the command, unless it is at a bound   |
|                           | and e u > 0                                              |
| `legacy`                  | I += i e dt before the command, which has I between its  |
|                           | bounds; with antiwindup I itself is kept between them    |

There is no integration while |e| is at most the deadband. Without `legacy` I is then
kept between its bounds.

Source: control_toolbox@6.x src/pid.cpp, Pid::compute_command; `legacy` that of @4.x.
"""

from math import inf

from station.memory.doubles import doubles, zeros

STRATEGIES = {
    "none": 0.0,
    "legacy": 1.0,
    "legacy with antiwindup": 2.0,
    "back_calculation": 3.0,
    "conditional_integration": 4.0,
}
"""Numbers that stand for the strategies."""
_NONE, _LEGACY, _CLAMPED, _BACK, _CONDITIONAL = STRATEGIES.values()


class SaturatingPids:
    """n PIDs in memory, shape (n,) each; the owner writes all but the last three.

    Args:
        size: The number n.

    Attributes:
        errors: References minus measured values; a command stays where one is NaN.
        rates: Rates of the errors, where they are known.
        forward: Feed-forward part of the commands.
        p, i, d, f: Gains; the owner uses `f` for `forward`.
        part_max, part_min: Bounds of the integral parts.
        maximum, minimum: Bounds of the commands.
        tracking: Time constants T of `back_calculation` [s], > 0.
        deadband: Errors without integration, >= 0; negative for none.
        strategies: Values of `STRATEGIES`.
        commands: The commands.
        parts: The integral parts.
        last: The last errors.
    """

    def __init__(self, size: int) -> None:
        self.size = size
        self.errors = zeros(size)
        self.rates = zeros(size)
        self.forward = zeros(size)
        self.p, self.i, self.d = zeros(size), zeros(size), zeros(size)
        self.f = zeros(size)
        self.part_max, self.part_min = doubles([inf] * size), doubles([-inf] * size)
        self.maximum, self.minimum = doubles([inf] * size), doubles([-inf] * size)
        self.tracking, self.deadband = doubles([1.0] * size), zeros(size)
        self.strategies = zeros(size)
        self.commands = zeros(size)
        self.parts = zeros(size)
        self.last = zeros(size)

    def reset(self) -> None:
        """Forget errors and integral parts."""
        for k in range(self.size):
            self.parts[k] = self.last[k] = self.commands[k] = 0.0

    def compute_commands(self, period: float, rates_known: bool) -> None:  # noqa: FBT001 - C
        """Write the commands; without time they stay.

        Args:
            period: Time since the last computation [s], >= 0.
            rates_known: Whether the owner has written the rates of the errors.
        """
        if period == 0.0:
            return
        for k in range(self.size):
            error = self.errors[k]
            # Only the difference of a finite number to itself is 0.
            if error - error != 0.0:
                continue
            # A rate that is not known of this one follows from the errors.
            if rates_known and self.rates[k] - self.rates[k] == 0.0:
                rate = self.rates[k]
            else:
                rate = (error - self.last[k]) / period
                self.last[k] = error
            self.commands[k] = self.forward[k] + self.saturated(k, period, rate)

    def saturated(self, k: int, period: float, rate: float) -> float:
        """Return the command of one PID, and integrate its error."""
        error, strategy = self.errors[k], self.strategies[k]
        within = error if error >= 0.0 else -error
        integrates = within > self.deadband[k]
        part = self.parts[k]
        if strategy in {_LEGACY, _CLAMPED}:
            if integrates:
                part += self.i[k] * period * error
            clamped = _bounded(part, self.part_min[k], self.part_max[k])
            self.parts[k] = clamped if strategy == _CLAMPED else part
            part = clamped
        free = self.p[k] * error + part + self.d[k] * rate
        command = _bounded(free, self.minimum[k], self.maximum[k])
        if integrates and strategy == _BACK and self.i[k] != 0.0:
            drawn = (command - free) / self.tracking[k]
            self.parts[k] += period * (self.i[k] * error + drawn)
        elif integrates and (
            strategy == _NONE
            or (
                strategy == _CONDITIONAL
                and not (free != command and error * free > 0.0)
            )
        ):
            self.parts[k] += period * self.i[k] * error
        if strategy not in {_LEGACY, _CLAMPED}:
            self.parts[k] = _bounded(self.parts[k], self.part_min[k], self.part_max[k])
        return command


def _bounded(value: float, low: float, high: float) -> float:
    value = min(value, high)
    return max(value, low)
