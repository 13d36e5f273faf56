"""Verbs about loaded controllers, their parameters and the hardware under them."""

import json
from argparse import Namespace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from station.cli.connection import open_client
from station.cli.errors import UsageError
from station.cli.output import answer, answer_table, number, say, say_json, say_table
from station.cli.parser import read_json
from station.core.errors import suggest

if TYPE_CHECKING:
    from pydantic import JsonValue

    from station.cli.parser import Parser
    from station.wire import (
        ControllerChains,
        ControllerState,
        ControllerType,
        DeclaredParameter,
        Hardware,
        HardwareLimits,
    )


def add_load_controller(parser: "Parser") -> None:
    """Add the arguments of `load_controller`."""
    add = parser.add_argument
    add("name")
    source = "ROS parameter file with its parameters; else the station's configuration"
    add("param_file", nargs="?", type=Path, metavar="PARAM_FILE", help=source)
    add("--type", help="its type, when no parameters say it")
    add(
        "--load-timeout",
        type=float,
        dest="timeout",
        metavar="S",
        help="longest init [s]",
    )
    add("--set-state", choices=("inactive", "active"), help="active: start it, too")


def add_unload_controller(parser: "Parser") -> None:
    """Add the arguments of `unload_controller`."""
    parser.add_argument("name")


def add_reload_controller_libraries(parser: "Parser") -> None:
    """Add the arguments of `reload_controller_libraries`."""
    parser.add_argument(
        "--force-kill", action="store_true", help="unload all controllers first"
    )


def add_list_controllers(parser: "Parser") -> None:
    """Add the arguments of `list_controllers`."""
    add = parser.add_argument
    add(
        "--claimed-interfaces",
        "--required-command-interfaces",
        action="store_true",
        help="what each claims",
    )
    add(
        "--chained-interfaces",
        "--exported-interfaces",
        action="store_true",
        help="references and states of other controllers: as view_controller_chains",
    )
    add("-v", "--verbose", action="store_true", help="claims, loop time and faults")


def add_list_controller_types(parser: "Parser") -> None:
    """Add the arguments of `list_controller_types`."""
    parser.add_argument(
        "type", nargs="?", metavar="TYPE", help="list the parameters of this type"
    )


def add_list_hardware_interfaces(parser: "Parser") -> None:
    """Add the arguments of `list_hardware_interfaces`."""
    parser.add_argument(
        "-v", "--verbose", action="store_true", help="limits, repairs, clamps and more"
    )


def add_list_hardware_components(parser: "Parser") -> None:
    """Add the arguments of `list_hardware_components`."""
    parser.add_argument(
        "-v", "--verbose", action="store_true", help="interfaces that can be read, too"
    )


def add_set_hardware_component_state(parser: "Parser") -> None:
    """Add the arguments of `set_hardware_component_state`."""
    states = ("unconfigured", "inactive", "active", "finalized")
    parser.add_argument("name", help="the component")
    parser.add_argument("state", choices=states)
    stops = "stop the controllers that command it; else it stays active"
    parser.add_argument("--stop-controllers", action="store_true", help=stops)


def list_hardware_components(options: Namespace) -> int:
    """Print the hardware components with their states and interfaces."""
    with open_client(options) as client:
        components = client.hardware_components()
    if options.json:
        return answer(options, components)
    for one in components:
        problem = f" ({one.problem})" if one.problem else ""
        say(f"{one.name}: {one.state}{problem}, {one.type}, {one.plugin}")
        beside = one.async_update
        if beside is not None:
            say(
                f"  asynchronous ({beside.policy}): states {beside.age} cycles old, "
                f"{1e3 * beside.duration.p50:.3g} ms every "
                f"{1e3 * beside.period.p50:.3g} ms, left out {beside.missed}"
            )
        kinds = [("commanded", one.command_interfaces)]
        if options.verbose:
            kinds.append(("read", one.state_interfaces))
        rows = [
            [
                each.resource,
                each.hardware_interface,
                what,
                "available" if each.is_available else "unavailable",
                ", ".join(each.claimed_by) or "-",
            ]
            for what, interfaces in kinds
            for each in interfaces
        ]
        if rows:
            say_table(
                ["resource", "hardware interface", "is", "state", "claimed by"], rows
            )
    return 0


def set_hardware_component_state(options: Namespace) -> int:
    """Bring a hardware component into a state of its life cycle."""
    with open_client(options) as client:
        component = client.set_hardware_component_state(
            options.name, options.state, stop_controllers=options.stop_controllers
        )
    return answer(options, component, f"{component.name} is {component.state}.")


def add_view_controller_chains(parser: "Parser") -> None:
    """Add the arguments of `view_controller_chains`."""
    parser.add_argument(
        "--dot", action="store_true", help="a graph for Graphviz: … --dot | dot -Tsvg"
    )


def view_controller_chains(options: Namespace) -> int:
    """Print the controllers in the order of their updates, with their chains."""
    with open_client(options) as client:
        chains = client.chains()
    if options.dot:
        return answer(options, chains, _graph(chains))
    headers = ["update", "name", "state", "mode", "commands", "exports"]
    return answer_table(options, chains, headers, _chain_rows(chains))


def _chain_rows(chains: "ControllerChains") -> list[list[str]]:
    rows = []
    for place, one in enumerate(chains.controllers, 1):
        exports = [
            f"{kind} {each.name}" + (f" ({', '.join(each.users)})" * bool(each.users))
            for kind, values in (("reference", one.references), ("state", one.states))
            for each in values
        ]
        rows.append([
            str(place),
            one.name,
            one.state,
            ("chained" if one.is_in_chained_mode else "-"),
            ", ".join(one.following) or "-",
            "; ".join(exports) or "-",
        ])
    return rows


def _graph(chains: "ControllerChains") -> str:
    """Return the chains in the language of Graphviz; running controllers are filled."""
    quoted = json.dumps
    lines = ["digraph controllers {", "  rankdir=LR; node [shape=box];"]
    for one in chains.controllers:
        style = ' [style=filled fillcolor="#d0e8d0"]' if one.state == "running" else ""
        lines.append(f"  {quoted(one.name)}{style};")
        edges = [(each, "solid", False) for each in one.references]
        edges += [(each, "dashed", True) for each in one.states]
        for value, line, is_state in edges:
            label = quoted(value.name.removeprefix(f"{one.name}/"))
            for user in value.users:
                ends = (one.name, user) if is_state else (user, one.name)
                first, second = map(quoted, ends)
                lines.append(f"  {first} -> {second} [label={label} style={line}];")
    return "\n".join([*lines, "}"])


def list_controllers(options: Namespace) -> int:
    """Print the loaded controllers."""
    if options.chained_interfaces:
        options.dot = False
        return view_controller_chains(options)
    with open_client(options) as client:
        controllers = client.controllers()
    headers = ["name", "type", "state"]
    if options.claimed_interfaces or options.verbose:
        headers.append("claimed interfaces")
    if options.verbose:
        headers.append("p99 of update [us]")
    if options.verbose or any(controller.fault for controller in controllers):
        headers.append("fault")
    rows = [_row(c, headers) for c in controllers]
    nothing = "No controllers are loaded."
    answer_table(options, controllers, headers, rows, nothing)
    for controller in () if options.json else controllers:
        for note in controller.notes:
            say(f"{controller.name}: {note}")
    return 0


def _row(controller: "ControllerState", headers: list[str]) -> list[str]:
    claims = [
        f"{claimed.hardware_interface}: {', '.join(claimed.resources)}"
        for claimed in controller.claimed_resources
        if claimed.resources
    ]
    time = controller.time
    cells = {
        "name": controller.name,
        "type": controller.type,
        "state": controller.state,
        "claimed interfaces": "; ".join(claims) or "-",
        "p99 of update [us]": f"{time.p99 * 1e6:.0f}" if time.count else "-",
        "fault": " ".join((controller.fault or "-").split()),
    }
    return [cells[header] for header in headers]


def list_controller_types(options: Namespace) -> int:
    """Print the types of controllers that can be loaded."""
    with open_client(options) as client:
        types = client.controller_types()
    if options.type is not None:
        types = [_find_type(types, options.type)]
    headers, rows = ["type", "description"], [[t.type, _about(t)] for t in types]
    if options.type is not None:
        headers = ["parameter", "type", "unit", "default", "allowed", "description"]
        rows = [_parameter_row(each) for each in types[0].parameters]
        if not options.json:
            say(f"{types[0].type}: {_about(types[0])}")
    return answer_table(options, types, headers, rows)


def _find_type(types: "list[ControllerType]", name: str) -> "ControllerType":
    """Return the type of that name.

    Raises:
        UsageError: The type is unknown.
    """
    for each in types:
        if each.type == name:
            return each
    raise UsageError(
        f"There is no controller type '{name}'. "
        f"{suggest(name, [each.type for each in types])}"
    )


def _about(controller_type: "ControllerType") -> str:
    """Return the description of a type, or why it cannot be imported."""
    if controller_type.error:
        return f"cannot be imported: {controller_type.error}"
    return controller_type.description


def _parameter_row(parameter: "DeclaredParameter") -> list[str]:
    default = parameter.default_text or json.dumps(parameter.default)
    return [
        parameter.name,
        parameter.type.replace("_", " "),
        parameter.unit,
        "required" if parameter.required else default,
        _allowed(parameter),
        parameter.description,
    ]


def _allowed(parameter: "DeclaredParameter") -> str:
    if parameter.choices:
        return ", ".join(parameter.choices)
    sign = ">" if parameter.excludes_minimum else ">="
    bounds = [
        f"{sign} {parameter.minimum:g}" if parameter.minimum is not None else "",
        f"<= {parameter.maximum:g}" if parameter.maximum is not None else "",
    ]
    return ", ".join(bound for bound in bounds if bound)


def load_controller(options: Namespace) -> int:
    """Load a controller, with the parameters of a file or of the station."""
    params = None
    if options.param_file is not None:
        params = _parameters_of(options.name, options.param_file, options.type)
    with open_client(options) as client:
        state = client.load_controller(
            options.name,
            options.type,
            params,
            timeout=options.timeout,
            unknown_params="tell",
        )
        if options.set_state == "active":
            client.switch_controllers(start=[options.name])
            state = client.controller(options.name)
    line = f"Loaded {state.name} ({state.type}); it is {state.state}."
    return answer(options, state, line, *(f"Note: {note}" for note in state.notes))


def _parameters_of(name: str, path: Path, kind: str | None) -> dict[str, Any]:
    """Return the parameters that a file written for ROS has for a controller.

    Raises:
        UsageError: The file has no parameters for that name.
    """
    # Imported late, because other verbs need no reader of configurations.
    from station.config.ros_parameters import split_ros_parameters
    from station.core.yaml_reader import read_yaml

    types = {} if kind is None else {name: kind}
    found = split_ros_parameters(read_yaml(path).values, str(path), types)
    params = found.controllers.get(name) or found.others.get(name)
    if not isinstance(params, dict):
        known = ", ".join(found.controllers) or "none"
        raise UsageError(
            f"{path} has no parameters for '{name}'; it has controllers: {known}.",
            remedy="Use one of these names, or add the parameters to the file.",
        )
    return params


def unload_controller(options: Namespace) -> int:
    """Unload a controller."""
    with open_client(options) as client:
        state = client.unload_controller(options.name)
    return answer(options, state, f"Unloaded {state.name}.")


def reload_controller_libraries(options: Namespace) -> int:
    """Let the next load of each type import its Python module again."""
    with open_client(options) as client:
        unloaded = client.reload_controller_types(force_kill=options.force_kill)
    line = f"Unloaded: {', '.join(unloaded) or 'no controller'}."
    return answer(options, unloaded, line)


def list_hardware_interfaces(options: Namespace) -> int:
    """Print the resources that controllers can claim, and their owners."""
    with open_client(options) as client:
        hardware = client.hardware()
    rows = [
        [resource.name, interface.name, ", ".join(resource.claimed_by) or "-"]
        for interface in hardware.interfaces
        for resource in interface.resources
    ]
    headers = ["resource", "hardware interface", "claimed by"]
    answer_table(options, hardware, headers, rows)
    if options.verbose and not options.json:
        _say_details(hardware)
    return 0


def _say_details(hardware: "Hardware") -> None:
    say("")
    headers = ["joint", "position", "velocity", "effort", "soft", "from"]
    say_table(headers, [_limits_row(limits) for limits in hardware.limits])
    transmissions = [
        [t.name, t.type, ", ".join(t.actuators), ", ".join(t.joints)]
        for t in hardware.transmissions
    ]
    repairs = [[r.element, r.problem, r.old or "-", r.new] for r in hardware.repairs]
    clamps = [
        [
            c.joint,
            c.hardware_interface,
            f"{c.count}",
            number(c.asked),
            number(c.given),
            c.reason,
        ]
        for c in hardware.clamps
    ]
    for headers, rows in (
        (["transmission", "type", "actuators", "joints"], transmissions),
        (["repaired", "problem", "was", "is"], repairs),
        (
            ["clamped joint", "hardware interface", "count", "asked", "given", "why"],
            clamps,
        ),
    ):
        if rows:
            say("")
            say_table(headers, rows)


def _limits_row(limits: "HardwareLimits") -> list[str]:
    soft = limits.soft_limits
    kinds = ("position", "velocity", "effort", "soft")
    sources = dict.fromkeys(
        limits.sources[kind] for kind in kinds if kind in limits.sources
    )
    return [
        limits.joint,
        _range(limits.min_position, limits.max_position),
        number(limits.max_velocity),
        number(limits.max_effort),
        "-" if soft is None else _range(soft.min_position, soft.max_position),
        ", ".join(sources) or "-",
    ]


def _range(low: float | None, high: float | None) -> str:
    return "-" if low is None or high is None else f"{low:g} to {high:g}"


def add_parameters(parser: "Parser") -> None:
    """Add the arguments of `parameters`."""
    add = parser.add_argument
    add("action", choices=("get", "set", "delete"))
    add("path", nargs="?", default="", metavar="PATH", help="e.g. arm/gains/j1/p")
    add("value", nargs="?", metavar="VALUE", help="JSON, such as 0.5 or [1,2], or text")


def parameters(options: Namespace) -> int:
    """Print, set or delete a parameter.

    Raises:
        UsageError: There are too few or too many words.
    """
    takes_value = options.action == "set"
    is_named = bool(options.path.strip("/")) or options.action == "get"
    if takes_value != (options.value is not None) or not is_named:
        raise UsageError(
            f"The words after `parameters {options.action}` are too few or too many.",
            remedy="station parameters get [PATH], set PATH VALUE, delete PATH.",
        )
    with open_client(options) as client:
        if options.action == "set":
            value: JsonValue = read_json(options.value)
            client.set_parameter(options.path, value)
            answer(options, value, "Done.")
        elif options.action == "delete":
            say_json(client.delete_parameter(options.path))
        else:
            say_json(client.parameter(options.path))
    return 0
