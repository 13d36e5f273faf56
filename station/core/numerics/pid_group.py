"""Turn the errors of joints into commands: proportional, integral, derivative part.

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
| command          | `p * error + i term + d * rate`                                  |

Source: control_toolbox@de05a5c src/pid.cpp, Pid.
"""

from station.memory.doubles import Doubles, Storage, own_zeros

NO_ERROR = 1
"""Bit for a period of 0 or an error that is not finite."""
NO_RATE = 2
"""Bit for a rate that is not finite."""


def add_feed_forward(commands: Storage, rates: Doubles, shares: Doubles) -> None:
    """Add shares of desired rates to commands in place, shape (n,) each."""
    for k in range(len(commands)):
        commands[k] = shares[k] * rates[k] + commands[k]


class PidGroup:
    """The PIDs of n joints, which read errors and write commands in place.

    Args:
        errors: Targets minus measured values, shape (n,); the owner writes them.
        rates: Rates of the errors [1/s], shape (n,); written by the owner, or computed.
        commands: Where the commands are written, shape (n,).
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

    def set_gains(
        self, k: int, p: float, i: float, d: float, i_max: float, i_min: float
    ) -> None:
        """Set the gains of joint `k`; its error and integral stay."""
        self.p[k] = p
        self.i[k] = i
        self.d[k] = d
        self.i_max[k] = i_max
        self.i_min[k] = i_min

    def set_antiwindup(self, k: int, bounds_integral: bool) -> None:  # noqa: FBT001
        """Bound the integral of joint `k` itself, or only the integral part."""
        self.antiwindup[k] = 1.0 if bounds_integral else 0.0

    def reset(self) -> None:
        """Forget all errors; the next rates are computed from errors of 0."""
        for k in range(self.n):
            self.reset_to(k, 0.0, 0.0)
            self.last[k] = 0.0

    def reset_to(self, k: int, rate: float, integral: float) -> None:
        """Forget the last error of joint `k`, and set its rate and integral.

        Args:
            k: Index of the joint.
            rate: Rate of the error that the next `compute` uses [1/s].
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

    def compute(self, period: float) -> int:
        """Compute the commands from the errors; their rates follow from the last ones.

        The command of a joint is 0, and nothing else of it changes, when the period is
        0 or its error is not finite. It is 0, and its integral stays, when its rate is
        not finite.

        Args:
            period: Time since the last computation [s].

        Returns:
            Bits that say why commands were not computed, see `NO_ERROR` and `NO_RATE`;
            0 when all were.
        """
        return self.follow(period, False)  # noqa: FBT003 - a C function

    def compute_with_rates(self, period: float) -> int:
        """Compute the commands from the errors and the rates that the owner wrote.

        The command of a joint is 0, and its integral stays, when the period is 0 or its
        error or rate is not finite.

        Args:
            period: Time since the last computation [s].

        Returns:
            As `compute`.
        """
        return self.follow(period, True)  # noqa: FBT003 - a C function

    def follow(self, period: float, rates_known: bool) -> int:  # noqa: FBT001
        """Compute the commands; see `compute` and `compute_with_rates`."""
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
                mask |= 1
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
                mask |= 2
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
        return mask
