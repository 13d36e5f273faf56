"""The verbs of the command line, in the order of `station --help`.

The module of a verb has two functions: `NAME` takes the parsed arguments and returns
the exit code; `add_NAME` adds the arguments, if the verb has any.
"""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Verb:
    """A verb of the command line.

    Attributes:
        module: Its module below `station.cli.verbs`.
        name: The verb.
        summary: Effect of the verb, in the imperative.
        aliases: Other names.
        is_client: Whether it talks to a running station.
    """

    module: str
    name: str
    summary: str
    aliases: tuple[str, ...] = ()
    is_client: bool = True


_TABLE = """\
run run: run a station until Ctrl-C
run fci: serve a simulated Franka arm to programs that use libfranka, or check an arm
ui ui: run the dashboard alone, for any station
doctor doctor: say whether this machine is fit for a station, or what a robot needs
run fetch_robot: fetch the Panda, as `run` does
controllers list_controllers list: list the loaded controllers
controllers view_controller_chains: print who commands whose references, as text or for
    Graphviz
controllers list_controller_types list_types: list what can be loaded, or the parameters
    of one type
controllers list_hardware_interfaces: list what can be claimed and who claims it
controllers list_hardware_components: list the parts of the robot that have a life
    cycle, and their states
controllers set_hardware_component_state: configure, activate, deactivate or shut down a
    part of the robot
controllers load_controller load configure_controller: load a controller, without
    starting it
controllers unload_controller unload cleanup_controller: unload a controller that is not
    running; its parameters stay
switching switch_controllers: start and stop controllers in one cycle
switching set_controller_state: load, start, stop or unload a controller, in the words
    of ROS 2
switching start: start loaded controllers
switching spawn spawner: load and start controllers of the station's configuration
switching kill: stop and unload controllers
gains gains: show or set the gains of a controller; save, compare and apply sets of
    gains
bench bench: excite a joint and say how it follows; propose and apply gains
bench lesson: list, begin and check exercises on the simulated robot
controllers parameters: read and change the tree of parameters that controllers are
    loaded with
controllers reload_controller_libraries: let the next load of each type read its Python
    module anew
streams echo: print what a topic says, until Ctrl-C
motion command: send a controller a set-point
motion goto: move to a pose, or a controller's joints, and wait
motion motion_sequence: follow PTP, LIN and CIRC motions of a file that blend into each
    other, and wait
rehearsal rehearse: tell how a motion would end, without moving anything; exit code 1
    when it fails
motion stop: stop the robot and let nothing move until released. With the names of
    loaded controllers: stop these alone. Any other word stops the robot
motion recover: clear the errors of an arm in reflex
motion release: take back a stop; nothing resumes by itself
robot gripper: home, open, close or stop an arm's gripper, and wait until it is done
simulation pause: let simulated time stand still
simulation resume: let simulated time pass again
simulation step: run some cycles while paused
simulation reset: put the simulated world back to its start; running controllers start
    anew
simulation scene: list, put or remove the objects that arms keep clear of
records record: record every cycle; list, fetch, delete and run recordings again
records incidents: list or fetch what was kept of stops, reflexes, overruns and faults
records recover_file: mend a recording whose end is missing, or that has damaged bytes
robot robot: list the services of a robot, or call one of them
streams events: print what happened: who did what, with what result
access control: show who holds control, take it, or give it back
access token: make, list or revoke named tokens
access agents: list what agents ask for; allow or refuse it
access mcp: serve an agent that speaks the Model Context Protocol
experiments sweep: run a trial for each of many values of parameters
experiments robustness: run trials under chance loads, friction and delays
experiments tune: search for better gains with CMA-ES
identification identify: fit friction and inertia of a joint to a motion
doctor validate: check a robot and its controllers; exit code 1 when a check fails
experiment_results experiments: look at, watch, cancel, draw, compare, replay, export
    and apply experiments
"""
"""One line per verb, `MODULE NAME ALIASES: EFFECT`; an indented line continues it."""
_ALONE = frozenset([
    "run",
    "fci",
    "doctor",
    "fetch_robot",
    "recover_file",
    "identify",
    "validate",
])
"""Verbs that need no running station."""


def _read(line: str) -> Verb:
    names, _, summary = line.partition(": ")
    module, name, *aliases = names.split()
    return Verb(module, name, summary, tuple(aliases), is_client=name not in _ALONE)


VERBS = tuple(map(_read, _TABLE.replace("\n    ", " ").splitlines()))
