"""Verb `identify`."""

from argparse import Namespace
from collections.abc import Mapping

from station.cli.errors import UsageError
from station.cli.output import say, say_json, say_table
from station.experiments.identification import Estimate, JointModel
from station.experiments.identification import identify as fit
from station.experiments.recordings import SUFFIX, recorded_trace
from station.experiments.trial_world import TrialWorld
from station.trials.errors import ExperimentError
from station.trials.parameters import check
from station.trials.script import Script, read_script
from station.trials.setup import Setup
from station.trials.trace import Trace, read_trace
from station.trials.trial import Trial
from station.wire.excitations import Multisine

_FREQUENCIES = (0.5, 1.1, 1.9, 3.1)
_IDENTIFYING = 4.0


def identify(options: Namespace) -> int:
    """Fit friction and inertia of a joint to a motion."""
    if options.recording is None:
        trace = _excite(options)
    elif options.recording.suffix == SUFFIX:
        trace = recorded_trace(options.recording)
    else:
        trace = read_trace(options.recording)
    found = fit(trace, options.joint)
    if options.record is not None:
        options.record.write_bytes(trace.to_bytes())
    if options.json:
        say_json({
            name: {"value": one.value, "half_width": one.half_width, "unit": one.unit}
            for name, one in _estimates(found).items()
        })
        return 0
    rows = [
        [name, f"{one.value:.4g}", f"± {one.half_width:.2g}", one.unit]
        for name, one in _estimates(found).items()
    ]
    say_table(["parameter", "value", "95 %", "unit"], rows)
    say(f"{found.samples} samples; {found.residual:.3g} Nm or N are not explained.")
    return 0


def read_number(word: str, *, check_name: bool = False) -> tuple[str, float]:
    """Return name and value of `NAME=VALUE`.

    Raises:
        UsageError: The text has another form.
    """
    name, equals, text = word.rpartition("=")
    try:
        value = float(text if equals and name else "no number")
    except ValueError as error:
        raise UsageError(
            f"{word!r} is not NAME=VALUE with a number.",
            remedy="Write it like load=1.5.",
        ) from error
    if check_name:
        check(name, value)
    return name, value


def _excite(options: Namespace) -> Trace:
    """Return a simulated motion of the joint.

    Raises:
        ExperimentError: The trial failed.
    """
    setup = Setup.load(options.config, controllers=options.controllers)
    parameters = dict(read_number(word, check_name=True) for word in options.parameters)
    if options.script is not None:
        script = read_script(options.script)
    else:
        motion = Multisine(
            joint=options.joint, amplitude=options.amplitude, frequencies=_FREQUENCIES
        )
        script = Script(
            controller=options.controller, duration=_IDENTIFYING, commands=(motion,)
        )
    with TrialWorld(setup) as world:
        result, trace = world.record(Trial(setup, script, parameters))
    if trace is None or result.state == "failed":
        raise ExperimentError(f"The motion failed. {result.reason}")
    return trace


def _estimates(found: JointModel) -> Mapping[str, Estimate]:
    return {
        "inertia": found.inertia,
        "viscous friction": found.viscous,
        "Coulomb friction": found.coulomb,
    }
