"""The verbs of the command line, in the order of `station --help`.

A verb has two functions in its module: one of its own name takes the parsed arguments
and returns the exit code; `add_NAME` adds the arguments, if it has any.
"""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Verb:
    """A verb of the command line.

    Attributes:
        module: Its module below `station.cli.verbs`.
        name: The verb.
        summary: Effect, in the imperative.
        aliases: Other names.
        is_client: Whether it talks to a running station.
    """

    module: str
    name: str
    summary: str
    aliases: tuple[str, ...] = ()
    is_client: bool = True


def _alone(module: str, name: str, summary: str) -> Verb:
    """Return a verb that needs no running station."""
    return Verb(module, name, summary, is_client=False)


VERBS = (
    _alone("run", "run", "run a station until Ctrl-C"),
    _alone(
        "run",
        "fci",
        "serve a simulated Franka arm to programs that use libfranka, or check an arm",
    ),
    Verb("ui", "ui", "run the dashboard alone, for any station"),
    _alone(
        "doctor",
        "doctor",
        "say whether this machine is fit for a station, or what a robot needs",
    ),
    _alone("run", "fetch_robot", "fetch the Panda, as `run` does"),
    Verb("controllers", "list_controllers", "list the loaded controllers", ("list",)),
    Verb(
        "controllers",
        "view_controller_chains",
        "print who commands whose references, as text or for Graphviz",
    ),
    Verb(
        "controllers",
        "list_controller_types",
        "list what can be loaded, or the parameters of one type",
        ("list_types",),
    ),
    Verb(
        "controllers",
        "list_hardware_interfaces",
        "list what can be claimed and who claims it",
    ),
    Verb(
        "controllers",
        "list_hardware_components",
        "list the parts of the robot that have a life cycle, and their states",
    ),
    Verb(
        "controllers",
        "set_hardware_component_state",
        "configure, activate, deactivate or shut down a part of the robot",
    ),
    Verb(
        "controllers",
        "load_controller",
        "load a controller, without starting it",
        ("load", "configure_controller"),
    ),
    Verb(
        "controllers",
        "unload_controller",
        "unload a controller that is not running; its parameters stay",
        ("unload", "cleanup_controller"),
    ),
    Verb("switching", "switch_controllers", "start and stop controllers in one cycle"),
    Verb(
        "switching",
        "set_controller_state",
        "load, start, stop or unload a controller, in the words of ROS 2",
    ),
    Verb("switching", "start", "start loaded controllers"),
    Verb(
        "switching",
        "spawn",
        "load and start controllers of the station's configuration",
        ("spawner",),
    ),
    Verb("switching", "kill", "stop and unload controllers"),
    Verb(
        "gains",
        "gains",
        "show or set the gains of a controller; save, compare and apply sets of gains",
    ),
    Verb(
        "bench",
        "bench",
        "excite a joint and say how it follows; propose and apply gains",
    ),
    Verb(
        "lesson",
        "lesson",
        "list, begin and check exercises on the simulated robot",
    ),
    Verb(
        "parameters",
        "parameters",
        "read and change the tree of parameters that controllers are loaded with",
    ),
    Verb(
        "controllers",
        "reload_controller_libraries",
        "let the next load of each type read its Python module anew",
    ),
    Verb("streams", "echo", "print what a topic says, until Ctrl-C"),
    Verb("motion", "command", "send a controller a set-point"),
    Verb("motion", "goto", "move to a pose, or a controller's joints, and wait"),
    Verb(
        "rehearsal",
        "rehearse",
        "tell how a motion would end, without moving anything; exit code 1 when it "
        "fails",
    ),
    Verb(
        "motion",
        "stop",
        "stop the robot and let nothing move until released. With the names of loaded "
        "controllers: stop these alone. Any other word stops the robot",
    ),
    Verb("motion", "recover", "clear the errors of an arm in reflex"),
    Verb("motion", "release", "take back a stop; nothing resumes by itself"),
    Verb(
        "robot",
        "gripper",
        "home, open, close or stop an arm's gripper, and wait until it is done",
    ),
    Verb("simulation", "pause", "let simulated time stand still"),
    Verb("simulation", "resume", "let simulated time pass again"),
    Verb("simulation", "step", "run some cycles while paused"),
    Verb(
        "simulation",
        "reset",
        "put the simulated world back to its start; running controllers start anew",
    ),
    Verb("scene", "scene", "list, put or remove the objects that arms keep clear of"),
    Verb(
        "records",
        "record",
        "record every cycle; list, fetch, delete and run recordings again",
    ),
    Verb(
        "records",
        "incidents",
        "list or fetch what was kept of stops, reflexes, overruns and faults",
    ),
    _alone(
        "records",
        "recover_file",
        "mend a recording whose end is missing, or that has damaged bytes",
    ),
    Verb("robot", "robot", "list the services of a robot, or call one of them"),
    Verb("streams", "events", "print what happened: who did what, with what result"),
    Verb("access", "control", "show who holds control, take it, or give it back"),
    Verb("access", "token", "make, list or revoke named tokens"),
    Verb("agents", "agents", "list what agents ask for; allow or refuse it"),
    Verb("agents", "mcp", "serve an agent that speaks the Model Context Protocol"),
    Verb("experiments", "sweep", "run a trial for each of many values of parameters"),
    Verb(
        "experiments",
        "robustness",
        "run trials under chance loads, friction and delays",
    ),
    Verb("experiments", "tune", "search for better gains with CMA-ES"),
    _alone(
        "identification", "identify", "fit friction and inertia of a joint to a motion"
    ),
    _alone(
        "validate",
        "validate",
        "check a robot and its controllers; exit code 1 when a check fails",
    ),
    Verb(
        "experiment_results",
        "experiments",
        "look at, watch, cancel, draw, compare, replay, export and apply experiments",
    ),
)
