"""Verbs that start and stop controllers."""

from argparse import Namespace
from math import isinf
from typing import TYPE_CHECKING

from station.cli.connection import open_client
from station.cli.errors import UsageError
from station.cli.output import answer, say, say_json

if TYPE_CHECKING:
    from station.cli.parser import Parser
    from station.client import StationClient
    from station.wire import SwitchResult
    from station.wire.controllers import SwitchStrictness

_OUTCOMES = {
    "rolled_back": "Rolled back: what ran before runs again.",
    "halted": "Halted: the hardware carried out neither the switch nor its reversal.",
}


def add_switch_controllers(parser: "Parser") -> None:
    """Add the arguments of `switch_controllers`."""
    for option, dest in (("--activate", "start"), ("--deactivate", "stop")):
        parser.add_argument(
            option, nargs="+", action="extend", default=[], dest=dest, metavar="NAME"
        )
    strictness = parser.add_mutually_exclusive_group()
    strictness.add_argument("--strict", action="store_true", help="all or nothing")
    strictness.add_argument(
        "--best-effort", action="store_true", help="do what is possible"
    )
    strictness.add_argument(
        "--auto", action="store_true", help="start and stop whole chains"
    )
    strictness.add_argument(
        "--force-auto", action="store_true", help="and stop what is in the way"
    )
    parser.add_argument("--activate-asap", action="store_true")
    parser.add_argument(
        "--switch-timeout", type=float, dest="timeout", default=0.0, metavar="S"
    )
    bound = "longest switch without a timeout, s; inf: no limit"
    parser.add_argument(
        "--switch-bound", type=float, dest="bound", metavar="S", help=bound
    )
    parser.add_argument("--dry-run", action="store_true", help="only say what would be")


def add_start(parser: "Parser") -> None:
    """Add the arguments of `start`, `spawn` and `kill`."""
    parser.add_argument("names", nargs="+", metavar="NAME")


add_spawn = add_kill = add_start
_STATES = ("unconfigured", "inactive", "active")


def add_set_controller_state(parser: "Parser") -> None:
    """Add the arguments of `set_controller_state`."""
    parser.add_argument("name")
    parser.add_argument("state", choices=_STATES)


def switch_controllers(options: Namespace) -> int:
    """Start and stop controllers in one cycle.

    Raises:
        UsageError: No controller is named.
    """
    if not options.start and not options.stop:
        raise UsageError(
            "No controller is named.",
            remedy="Name some with --activate, --deactivate or both.",
        )
    from station.wire.controllers import SWITCH_BOUND

    bound = SWITCH_BOUND if options.bound is None else options.bound
    with open_client(options) as client:
        result = client.switch_controllers(
            start=options.start,
            stop=options.stop,
            strictness=_strictness(options),
            start_asap=options.activate_asap,
            timeout=options.timeout,
            bound=None if isinf(bound) else bound,
            dry_run=options.dry_run,
        )
    return _tell(result, options)


def _strictness(options: Namespace) -> "SwitchStrictness":
    if options.best_effort:
        return "best_effort"
    if options.force_auto:
        return "force_auto"
    return "auto" if options.auto else "strict"


def start(options: Namespace) -> int:
    """Start loaded controllers (ROS 1)."""
    with open_client(options) as client:
        return _tell(client.switch_controllers(start=options.names), options)


def set_controller_state(options: Namespace) -> int:
    """Bring a controller into the next state, as `ros2 control` does.

    A controller that is not loaded counts as unconfigured; its parameters stay.

    Raises:
        UsageError: The state is not one step from the present state.
    """
    name, wanted = options.name, _STATES.index(options.state)
    with open_client(options) as client:
        found = [one.state for one in client.controllers() if one.name == name]
        present = 0 if not found else 2 if found[0] == "running" else 1
        match present, wanted:
            case 0, 1:
                client.load_controller(name)
            case 1, 0:
                client.unload_controller(name)
            case 1, 2:
                return _tell(client.switch_controllers(start=[name]), options)
            case 2, 1:
                return _tell(client.switch_controllers(stop=[name]), options)
            case _ if present != wanted:
                raise UsageError(
                    f"'{name}' is {_STATES[present]}, and cannot become "
                    f"{options.state} at once.",
                    remedy="Set it inactive first.",
                )
    found_now = {"name": name, "state": options.state}
    return answer(options, found_now, f"{name} is {options.state}.")


def spawn(options: Namespace) -> int:
    """Load controllers and start them (ROS 1)."""
    with open_client(options) as client:
        for name in options.names:
            client.load_controller(name)
        return _tell(client.switch_controllers(start=options.names), options)


def kill(options: Namespace) -> int:
    """Stop the named controllers that run, and unload all named ones (ROS 1)."""
    with open_client(options) as client:
        result = _stop_running(client, options.names)
        if not options.json:
            _tell_stop(result, options)
        for name in options.names:
            client.unload_controller(name)
            if not options.json:
                say(f"Unloaded {name}.")
    if options.json:
        say_json({**dict(result or _NOTHING_STOPPED), "unloaded": options.names})
    return 0 if result is None or result.ok else 1


_NOTHING_STOPPED = {"ok": True, "stopped": [], "started": []}


def stop_running(client: "StationClient", options: Namespace) -> int:
    """Stop the named controllers that run."""
    return _tell_stop(_stop_running(client, options.names), options)


def _stop_running(client: "StationClient", names: list[str]) -> "SwitchResult | None":
    running = [name for name in names if client.controller(name).state == "running"]
    return client.switch_controllers(stop=running) if running else None


def _tell_stop(result: "SwitchResult | None", options: Namespace) -> int:
    if result is None:
        return answer(options, _NOTHING_STOPPED, "None of them is running.")
    return _tell(result, options)


def _tell(result: "SwitchResult", options: Namespace) -> int:
    if options.json:
        say_json(result)
        return 0 if result.ok else 1
    if result.outcome in _OUTCOMES:
        say(_OUTCOMES[result.outcome])
    would = "Would have " if result.dry_run else ""
    for what, names in (("stopped", result.stopped), ("started", result.started)):
        if names:
            word = f"{would}{what}".strip()
            say(f"{word[0].upper()}{word[1:]}: {', '.join(names)}.")
    if result.chained:
        order = (f"{n} (chained)" if n in result.chained else n for n in result.order)
        say(f"Order of updates: {', '.join(order)}.")
    jumps = {joint: jump for joint, jump in result.jump.items() if jump}
    if jumps:
        largest = max(jumps, key=lambda joint: abs(jumps[joint] or 0.0))
        say(f"Largest jump of a command: {jumps[largest]:.2g} at {largest}.")
    for name, reason in result.failed.items():
        say(f"{name} does not run: {reason}")
    for reason in result.ignored:
        say(f"Left out: {reason}")
    return 0 if result.ok else 1
