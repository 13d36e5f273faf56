"""Verb `identify`, and the options that choose the station of a trial."""

from argparse import Namespace
from pathlib import Path
from typing import TYPE_CHECKING

from station.cli.output import say, say_json, say_table
from station.cli.parser import add_controllers, read_number, unique

if TYPE_CHECKING:
    from collections.abc import Mapping

    from station.cli.parser import Parser
    from station.experiments.identification import Estimate, JointModel
    from station.trials.trace import Trace
    from station.trials.trial import Setup

_FREQUENCIES = (0.5, 1.1, 1.9, 3.1)
_IDENTIFYING = 4.0


def add_identify(parser: "Parser") -> None:
    """Add the arguments of `identify`."""
    add = parser.add_argument
    add("joint", metavar="JOINT")
    add(
        "--recording",
        type=Path,
        metavar="FILE.mcap",
        help="a recording of a station, or FILE.npz of --record",
    )
    add(
        "--controller",
        default="effort_group_position_controller",
        help="what moves the joint in a simulation, when there is no recording",
    )
    add("--amplitude", type=float, default=0.2, metavar="A", help="[rad or m]")
    add("--record", type=Path, metavar="FILE.npz", help="keep the simulated motion")
    add_setup(parser)


def add_setup(parser: "Parser") -> None:
    """Add the arguments for the trials' station and motions."""
    add = parser.add_argument
    add("--config", type=Path, metavar="CONFIG.yaml", help="a station's configuration")
    add_controllers(parser, "parameter files written for ROS")
    add(
        "--script",
        type=Path,
        metavar="SCRIPT.yaml",
        help="what happens in a trial, or a recording (.mcap) whose set-points are "
        "given again; without it all joints move to and fro for 2 s",
    )
    add(
        "--with",
        dest="parameters",
        nargs="+",
        action="extend",
        default=[],
        metavar="NAME=VALUE",
        help="parameters of every trial, e.g. load=1.5 scale/CONTROLLER/p=0.2",
    )


def load_setup(options: Namespace) -> "Setup":
    """Return the setup that the options of `add_setup` describe."""
    from station.trials.trial import Setup

    return Setup.load(options.config, controllers=options.controllers)


def read_parameters(options: Namespace) -> dict[str, float]:
    """Return the parameters of every trial from the option `--with`.

    Raises:
        UsageError: A word is not NAME=VALUE.
        ExperimentError: A parameter is unknown, or its value is not allowed.
    """
    from station.trials.parameters import check

    found = unique(map(read_number, options.parameters))
    for name, value in found.items():
        check(name, value)
    return found


def identify(options: Namespace) -> int:
    """Fit friction and inertia of a joint to a motion."""
    from station.experiments.identification import identify as fit
    from station.experiments.recordings import SUFFIX, recorded_trace
    from station.trials.trace import read_trace

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
    coulomb, viscous = found.coulomb.value, found.viscous.value
    friction = f"{{coulomb: {coulomb:.3g}, viscous: {viscous:.3g}}}"
    say(f"For a simulated Franka, robot: {{identified: {{{found.joint}: {friction}}}}}")
    return 0


def _excite(options: Namespace) -> "Trace":
    """Return a simulated motion of the joint.

    Raises:
        ExperimentError: The trial failed.
    """
    from station.experiments.trial_world import TrialWorld
    from station.trials.errors import ExperimentError
    from station.trials.trial import Script, Trial, read_script
    from station.wire.excitations import Multisine

    setup, parameters = load_setup(options), read_parameters(options)
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


def _estimates(found: "JointModel") -> "Mapping[str, Estimate]":
    return {
        "inertia": found.inertia,
        "viscous friction": found.viscous,
        "Coulomb friction": found.coulomb,
    }
