"""Compute the figures of one joint's test, and keep tests as runs, one JSON file each.

A test is a step, a sine, a Bode plot or a relay.
"""

import math
import threading
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path

import numpy as np
from pydantic import ValidationError

from station.core.errors import suggest
from station.core.hardware.robot_report import JointLimitsReport
from station.core.user_files import make_private_folder, user_folder
from station.trials.errors import BenchRunNotFoundError, ExperimentError
from station.trials.excitations import Array, fade_of
from station.trials.frequency_response import (
    Curve,
    JointResponse,
    figures_of,
    frequencies_between,
    joint_response,
    mass_and_damping,
    sine_figures,
)
from station.trials.metrics import UNITS, Counts, measure
from station.trials.relay_tuning import RULES, relay_figures
from station.trials.trace import Trace
from station.trials.trial import Script
from station.wire.excitations import (
    BenchResponse,
    BenchRun,
    Bode,
    BodeCurve,
    Chirp,
    Excitation,
    GainProposal,
    Multisine,
    PartRequest,
    Relay,
    Sine,
    Step,
)

FIGURE_UNITS: Mapping[str, str] = {
    "gain": "",
    "phase": "deg",
    "coherence": "",
    "bandwidth": "Hz",
    "resonance_peak": "",
    "gain_margin": "",
    "phase_margin": "deg",
    "gain_crossover": "Hz",
    "phase_crossover": "Hz",
    "period": "s",
    "amplitude": "rad or m",
    "ultimate_gain": "command per rad or m",
    "ultimate_period": "s",
    "inertia": "kg m^2 or kg",
    "damping": "Nm s/rad or N s/m",
    "delay": "s",
}
"""Unit of each figure that a test has besides the metrics of a trial."""
_MOST_POINTS = 500
_SETTLED = 0.25
"""Share of a sine's duration after which its response counts as steady."""
_SUFFIX = ".json"


def gain_names(gains: Mapping[str, float], joint: str) -> dict[str, str]:
    """Return the names of a joint's p, i and d among a controller's gains.

    Args:
        gains: The gains of the controller.
        joint: The joint; a controller of a single joint does not name it.
    """
    for start in (f"{joint}/", ""):
        found = {key: start + key for key in "pid" if start + key in gains}
        if "p" in found:
            return found
    return {}


def joint_test(
    trace: Trace,
    excitation: Excitation,
    script: Script,
    gains: Mapping[str, float],
    limits: Sequence[JointLimitsReport] = (),
    counts: Counts | None = None,
) -> BenchResponse:
    """Return the response of a joint with all figures of its test.

    Args:
        trace: The motion of this joint only, one cycle at least.
        excitation: Excitation of the joint.
        script: The excitation as a script, with duration and settling band.
        gains: Gains in force during the test; empty if unknown.
        limits: Limits of the robot's joints.
        counts: Other counts of the test.
    """
    metrics = measure(trace, script, limits, counts)
    known = np.isfinite(trace.desired[:, 0])
    signals = {
        "desired": trace.desired[known, 0],
        "position": trace.position[known, 0],
        "output": trace.output[known, 0],
    }
    bode = None
    proposals: list[GainProposal] = []
    match excitation:
        case Step():
            pass
        case Sine():
            metrics |= _sine(signals, excitation, trace.period, script.duration)
        case Chirp() | Multisine():
            bode = joint_response(
                signals, trace.period, _frequencies(excitation, script.duration)
            )
            if bode is not None:
                metrics |= figures_of(bode) | mass_and_damping(bode)
        case Relay():
            metrics |= _relay(signals, excitation, trace, gains)
            proposals = proposals_of(metrics, gains, excitation.joint)
    every = max(1, math.ceil(len(trace.time) / _MOST_POINTS))

    def column(values: Array) -> list[float | None]:
        shown: list[float | None] = values[::every, 0].tolist()
        return shown

    return BenchResponse(
        created_at=datetime.now(UTC).isoformat(timespec="seconds"),
        controller=script.controller,
        joint=excitation.joint,
        kind=excitation.kind,
        amplitude=excitation.amplitude,
        gains=dict(gains),
        time=trace.time[::every].tolist(),
        desired=column(trace.desired),
        position=column(trace.position),
        velocity=column(trace.velocity),
        effort=column(trace.effort),
        output=column(trace.output),
        metrics={k: v for k, v in metrics.items() if math.isfinite(v)},
        units={**UNITS, **FIGURE_UNITS},
        cycles=len(trace.time),
        bode=None if bode is None else _bode(bode),
        proposals=proposals,
        lost=0,
    )


def proposals_of(
    metrics: Mapping[str, float], gains: Mapping[str, float], joint: str
) -> list[GainProposal]:
    """Return the gains by each rule; empty without an ultimate gain or a PID.

    Args:
        metrics: Figures of a relay test.
        gains: Gains of the controller.
        joint: The joint.
    """
    names = gain_names(gains, joint)
    if len(names) < 3 or "ultimate_gain" not in metrics:
        return []
    ku, tu = metrics["ultimate_gain"], metrics["ultimate_period"]
    found = []
    for key, rule in RULES.items():
        values = rule.gains(ku, tu)
        note = ""
        start = names["p"].removesuffix("p")
        if values["i"] and not gains.get(f"{start}i_clamp_max"):
            note = "The integral is limited to 0 until i_clamp_max is more than 0."
        named = {names[gain]: float(f"{value:.4g}") for gain, value in values.items()}
        found.append(
            GainProposal(
                rule=key, title=rule.title, source=rule.source, gains=named, note=note
            )
        )
    return found


def excitation_of_part(
    part: PartRequest, trace: Trace
) -> tuple[Excitation, Script, Trace]:
    """Return the excitation that a part of a recording shows, and its cycles.

    Args:
        part: How the part is to be read.
        trace: The motion of the joint in the part.
    """
    desired, joint = trace.desired[:, 0], part.joint
    size = 0.5 * float(np.ptp(desired[np.isfinite(desired)]))
    excitation: Excitation
    match part.kind:
        case "step":
            jumps = np.nan_to_num(np.diff(desired))
            at = int(np.abs(jumps).argmax()) if len(jumps) else 0
            height = float(jumps[at]) if len(jumps) else 0.0
            # The step ends where the set-point moves again, e.g. back.
            moved = np.abs(desired[at + 1 :] - desired[min(at + 1, len(desired) - 1)])
            on = np.flatnonzero(moved > 0.01 * abs(height))
            trace = trace.until(at + 1 + int(on[0]) if len(on) else len(desired))
            # The difference at `at` shows in the set-point of the next cycle.
            begin = float(trace.time[min(at + 1, len(trace.time) - 1)])
            excitation = Step(joint=joint, amplitude=height, at=begin)
        case "sine":
            excitation = Sine(joint=joint, amplitude=size, frequency=part.low)
        case "chirp" | "multisine":
            excitation = Chirp(
                joint=joint, amplitude=size, first=part.low, last=part.high
            )
        case "relay":
            excitation = Relay(joint=joint, amplitude=size)
    duration = max(float(trace.time[-1]), trace.period)
    script = Script(
        controller=part.controller, duration=duration, commands=(excitation,)
    )
    return excitation, script, trace


def _sine(
    signals: Mapping[str, Array], sine: Sine, period: float, duration: float
) -> dict[str, float]:
    length = duration - sine.at if sine.lasts is None else sine.lasts
    # Use the part between the fades, after the transient response has died away.
    begin = sine.at + max(fade_of(length), _SETTLED * length)
    part = slice(round(begin / period), round((sine.at + length) / period))
    last = round((sine.at + length - fade_of(length)) / period)
    part = slice(part.start, last)
    return sine_figures(
        signals["desired"][part], signals["position"][part], period, sine.frequency
    )


def _frequencies(excitation: Chirp | Multisine, duration: float) -> Array:
    if isinstance(excitation, Multisine):
        return np.unique(np.array(excitation.frequencies))
    low, high = sorted((excitation.first, excitation.last))
    # A record with less than two periods of a frequency cannot tell it from a trend.
    low = max(low, 2.0 / duration)
    return frequencies_between(low, max(high, 1.001 * low))


def _relay(
    signals: Mapping[str, Array],
    relay: Relay,
    trace: Trace,
    gains: Mapping[str, float],
) -> dict[str, float]:
    begin = round(relay.at / trace.period)
    desired, position, output = (signals[k][begin:] for k in signals)
    found = relay_figures(output, position, trace.period)
    names = gain_names(gains, relay.joint)
    if names and not any(gains[names[key]] for key in "id" if key in names):
        return found
    if not names and gains:  # a controller without PID: its output is the set-point
        return found
    # With i or d gains the phase crossover would be that of the loop, not of the joint.
    loop = relay_figures(desired - position, position, trace.period)
    if not loop:
        return {}
    return {
        "period": loop["period"],
        "amplitude": loop["amplitude"],
        "gain_margin": loop["ultimate_gain"],
        "phase_crossover": 1.0 / loop["ultimate_period"],
    }


def _bode(response: JointResponse) -> Bode:
    def curve(one: Curve) -> BodeCurve:
        return BodeCurve(gain=one.gain.tolist(), phase=one.phase.tolist())

    return Bode(
        frequency=response.frequency.tolist(),
        coherence=response.coherence.tolist(),
        closed_loop=curve(response.closed_loop),
        open_loop=curve(response.open_loop),
        plant=curve(response.plant),
    )


class KeptRuns:
    """The kept runs in a folder. Any thread.

    Args:
        folder: Folder of the files; the user's own folder when None. It is made when
            the first run is kept.
    """

    def __init__(self, folder: Path | None = None) -> None:
        self._folder = folder
        self._lock = threading.Lock()
        self._known: dict[str, tuple[int, BenchRun]] = {}

    @property
    def folder(self) -> Path:
        """Return the folder of the files."""
        return self._folder or user_folder("bench-runs")

    def keep(self, run: BenchResponse, name: str | None) -> BenchResponse:
        """Keep a run and return it with its name.

        Args:
            run: The run.
            name: Its name; it replaces a run of the same name. None makes a name of the
                kind and a number.

        Raises:
            ExperimentError: The file cannot be written.
        """
        with self._lock:
            if name is None:
                taken = {path.stem for path in self.folder.glob(f"*{_SUFFIX}")}
                number = len(taken) + 1
                while f"{run.kind}-{number}" in taken:
                    number += 1
                name = f"{run.kind}-{number}"
            kept = run.model_copy(update={"name": name})
            path = self._path(name)
            part = path.with_suffix(".part")
            try:
                make_private_folder(path.parent)
                # Write under another name first, so that a reader finds the old file or
                # the new one.
                part.write_text(kept.model_dump_json(), "utf-8")
                part.replace(path)
            except OSError as error:
                raise ExperimentError(f"{path} cannot be written: {error}.") from error
        return kept

    def list(self) -> list[BenchRun]:
        """Return all runs without their curves, the oldest first.

        Files that cannot be read are left out.
        """
        found = []
        with self._lock:
            for path in self.folder.glob(f"*{_SUFFIX}"):
                try:
                    stamp = path.stat().st_mtime_ns
                    known = self._known.get(path.stem)
                    if known is None or known[0] != stamp:
                        known = self._known[path.stem] = stamp, self._summary(path)
                except (OSError, ValueError):
                    continue  # a foreign file, or one deleted meanwhile
                found.append(known)
        return [run for _, run in sorted(found, key=lambda one: one[0])]

    def get(self, name: str) -> BenchResponse:
        """Return a run.

        Raises:
            BenchRunNotFoundError: There is no such run.
            ExperimentError: Its file cannot be read.
        """
        path = self._path(name)
        try:
            return self._read(path)
        except FileNotFoundError as error:
            raise BenchRunNotFoundError(
                f"There is no run '{name}' of the bench.",
                remedy=suggest(name, [run.name for run in self.list()]),
                details={"run": name},
            ) from error
        except (OSError, ValidationError) as error:
            raise ExperimentError(
                f"{path} cannot be read: {error}.", remedy="Delete it."
            ) from error

    def delete(self, name: str) -> BenchResponse:
        """Delete a run and return it.

        Raises:
            BenchRunNotFoundError: There is no such run.
            ExperimentError: Its file cannot be read.
        """
        found = self.get(name)
        with self._lock:
            self._path(name).unlink(missing_ok=True)
            self._known.pop(name, None)
        return found

    def _path(self, name: str) -> Path:
        return self.folder / f"{name}{_SUFFIX}"

    def _summary(self, path: Path) -> BenchRun:
        run = self._read(path)
        names = gain_names(run.gains, run.joint)
        gains = {key: run.gains[name] for key, name in names.items()}
        values = {
            name: getattr(run, name)
            for name in ("name", "created_at", "controller", "joint", "kind", "metrics")
        }
        return BenchRun(gains=gains, **values)

    @staticmethod
    def _read(path: Path) -> BenchResponse:
        return BenchResponse.model_validate_json(path.read_bytes())
