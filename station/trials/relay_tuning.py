"""Ultimate gain and period of a joint from a relay test, and gains by named rules."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from station.trials.excitations import Array

_FEWEST_PERIODS = 3
_HARMONICS = (1, 3, 5)
_POOR_FIT = 0.01
"""Share of the relay's power that a model may leave unexplained. A joint with mostly
dry friction leaves more; then only the first harmonic is used."""


@dataclass(frozen=True, slots=True)
class Rule:
    """A rule that computes gains from the ultimate gain Ku and period Tu.

    Attributes:
        title: Name for people.
        p: Ratio of p to Ku.
        integral: Ratio of the integral time to Tu; 0 without an integral.
        derivative: Ratio of the derivative time to Tu; 0 without a derivative.
        source: Publication.
    """

    title: str
    p: float
    integral: float
    derivative: float
    source: str

    def gains(self, ku: float, tu: float) -> dict[str, float]:
        """Return p, i and d of `p * e + i * integral(e) + d * rate(e)`."""
        p = self.p * ku
        return {
            "p": p,
            "i": p / (self.integral * tu) if self.integral else 0.0,
            "d": p * self.derivative * tu,
        }


_ZN = "J. G. Ziegler, N. B. Nichols, Optimum Settings for Automatic Controllers, 1942"
_TL = (
    "B. D. Tyreus, W. L. Luyben, Tuning PI Controllers for Integrator/Dead Time "
    "Processes, 1992; with derivative: W. L. Luyben, M. L. Luyben, Essentials of "
    "Process Control, 1997"
)
_SO = "D. E. Seborg, T. F. Edgar, D. A. Mellichamp, Process Dynamics and Control, 1989"
RULES: Mapping[str, Rule] = {
    "ziegler_nichols_p": Rule("Ziegler-Nichols P", 0.5, 0.0, 0.0, _ZN),
    "ziegler_nichols_pd": Rule("Ziegler-Nichols PD", 0.8, 0.0, 1 / 8, _ZN),
    "ziegler_nichols_pi": Rule("Ziegler-Nichols PI", 0.45, 1 / 1.2, 0.0, _ZN),
    "ziegler_nichols_pid": Rule("Ziegler-Nichols PID", 0.6, 1 / 2, 1 / 8, _ZN),
    "tyreus_luyben_pi": Rule("Tyreus-Luyben PI", 1 / 3.2, 2.2, 0.0, _TL),
    "tyreus_luyben_pid": Rule("Tyreus-Luyben PID", 1 / 2.2, 2.2, 1 / 6.3, _TL),
    "some_overshoot": Rule("Some overshoot", 0.33, 1 / 2, 1 / 3, _SO),
    "no_overshoot": Rule("No overshoot", 0.2, 1 / 2, 1 / 3, _SO),
}
"""The rules, by the name that the API and the command line use."""


def relay_figures(output: Array, position: Array, period: float) -> dict[str, float]:
    """Return the figures of the oscillation under a relay.

    The harmonics of command and position give the plant's response at the frequency of
    the oscillation and its odd multiples, exactly for a linear plant. If the phase
    there is not -180 degrees (a relay is not a sine, and has hysteresis), a model of
    second order with a delay is fitted to these responses, and the ultimate point is
    that of the model.

    Args:
        output: Commands of the controller, shape (n,).
        position: Positions of the joint, shape (n,).
        period: Time between two samples [s], > 0.

    Returns:
        `period` of the oscillation [s], its `amplitude`, `ultimate_gain` and
        `ultimate_period` [s]; nothing when fewer than three periods were measured.

    Source:
        K. J. Åström, T. Hägglund, Automatic tuning of simple regulators with
        specifications on phase and amplitude margins, Automatica 20, 1984.
    """
    found = _whole_periods(position)
    if found is None:
        return {}
    begin, end, periods = found
    tu = (end - begin) * period / periods
    first, last = math.ceil(begin), math.ceil(end)
    # The weight of a sample is the share of it that lies within whole periods.
    weight = np.ones(last - first)
    weight[0], weight[-1] = 0.5 + first - begin, 0.5 + end - (last - 1)
    place = 2.0 * math.pi * np.arange(first, last) * period / tu
    waves = {}
    for name, values in (("u", output), ("y", position)):
        part = values[first:last] - values[first:last].mean()
        waves[name] = np.array([
            2.0 * np.mean(part * weight * np.exp(-1j * k * place)) for k in _HARMONICS
        ])
    u, y = waves["u"], waves["y"]
    if abs(y[0]) == 0.0 or abs(u[0]) == 0.0:
        return {}
    omega = 2.0 * math.pi * np.array(_HARMONICS) / tu
    ultimate = _modelled(omega, u, y) or (float(abs(u[0] / y[0])), tu)
    return {
        "period": tu,
        "amplitude": float(abs(y[0])),
        "ultimate_gain": ultimate[0],
        "ultimate_period": ultimate[1],
    }


def _whole_periods(position: Array) -> tuple[float, float, int] | None:
    """Return begin and end [samples] and number of the whole periods at the end."""
    late = position[len(position) // 3 :]
    if len(late) < 8:
        return None
    middle = 0.5 * (float(late.max()) + float(late.min()))
    band = 0.2 * float(np.ptp(late))
    crossings, is_low = [], False
    for i, (before, value) in enumerate(pairwise(late.tolist())):
        # Noise around the middle must not count as a crossing: the joint must have been
        # below a band first.
        is_low = is_low or before < middle - band
        if is_low and before < middle <= value:
            share = (middle - before) / (value - before)
            crossings.append(len(position) // 3 + i + share)
            is_low = False
    if len(crossings) <= _FEWEST_PERIODS:
        return None
    return crossings[0], crossings[-1], len(crossings) - 1


def _modelled(omega: Array, u: Array, y: Array) -> tuple[float, float] | None:
    """Return Ku and Tu of a model fitted to the harmonics; None if none fits."""
    best: tuple[float, float, Array] | None = None
    longest = math.pi / omega[0]
    for delay in np.linspace(0.0, longest, 400).tolist():
        base = np.column_stack((y, 1j * omega * y, -(omega**2) * y))
        wanted = u * np.exp(-1j * omega * delay)
        rows = np.concatenate((base.real, base.imag))
        values = np.concatenate((wanted.real, wanted.imag))
        solved = np.linalg.lstsq(rows, values, rcond=None)[0]
        left = float(np.sum((rows @ solved - values) ** 2))
        if best is None or left < best[0]:
            best = left, delay, solved
    if best is None or best[0] > _POOR_FIT * float(np.sum(np.abs(u) ** 2)):
        return None
    _, delay, (stiffness, damping, mass) = best
    at = np.linspace(0.75, 1.35, 3001) * omega[0]
    answer = np.exp(-1j * at * delay) / (stiffness - mass * at**2 + 1j * at * damping)
    phase = np.unwrap(np.angle(answer))
    phase -= 2.0 * math.pi * math.ceil(phase[0] / (2.0 * math.pi))
    crossed = np.flatnonzero((phase[:-1] > -math.pi) & (phase[1:] <= -math.pi))
    if not len(crossed):
        return None
    i = int(crossed[0])
    return float(1.0 / abs(answer[i])), float(2.0 * math.pi / at[i])
