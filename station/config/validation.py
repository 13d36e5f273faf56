"""Validate a merged configuration, and describe its faults in words."""

from collections.abc import Callable
from typing import Any, get_args, get_origin

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from station.config.models import (
    MODULE_PATTERN,
    NAME_PATTERN,
    ORIGIN_PATTERN,
    PLUGIN_PATTERN,
    StationConfig,
)
from station.core.errors import ConfigError, key_text, show
from station.core.yaml_reader import KeyPath

# Names that controllers cannot have, because the parameter tree uses them.
RESERVED_NAMES = frozenset({"robot", "robot_description", "scene"})
_REMEDY = "Correct the configuration and start again."
_WANTED = {
    "string_type": "text; put it in quotes",
    "float_type": "a number",
    "int_type": "a whole number",
    "bool_type": "true or false",
    "list_type": "a list",
    "tuple_type": "two numbers, the lower one first",
    "dict_type": "a mapping",
    "model_type": "a mapping",
    "model_attributes_type": "a mapping",
    "finite_number": "a finite number",
}
_PATTERNS = {
    ORIGIN_PATTERN: "scheme, host and port of a page, e.g. https://lab.example:8443",
    MODULE_PATTERN: "the name of a Python module, e.g. my_package.my_controllers",
    NAME_PATTERN: "a name of letters, digits and underscores",
    PLUGIN_PATTERN: "package/Class, e.g. franka_hw/FrankaHW, or module:Class",
}


def validate(
    values: dict[str, object], where: Callable[[KeyPath], str]
) -> StationConfig:
    """Return the validated configuration that `values` describe.

    Args:
        values: The merged mappings.
        where: Function that returns the source of the value at a path.

    Raises:
        ConfigError: Values are not allowed; the message names each of them.
    """
    try:
        config = StationConfig.model_validate(values)
    except ValidationError as error:
        problems = [_problem(details, where) for details in error.errors()]
        raise ConfigError(problems, remedy=_REMEDY) from error
    _check_names(config, where)
    return config


def _check_names(config: StationConfig, where: Callable[[KeyPath], str]) -> None:
    known = ", ".join(config.controllers) or "none"
    problems = [
        f"{where(('start', i))}: start[{i}] is {show(name)}; allowed are the names in "
        f"'controllers': {known}."
        for i, name in enumerate(config.start)
        if name not in config.controllers
    ]
    problems += [
        f"{where(('controllers', name))}: controllers.{name} has a name that is taken: "
        f"the station keeps its own parameters under '{name}'."
        for name in RESERVED_NAMES & (config.controllers.keys() | config.parameters)
    ]
    if problems:
        raise ConfigError(problems, remedy=_REMEDY)


def _problem(details: ErrorDetails, where: Callable[[KeyPath], str]) -> str:
    path = details["loc"]
    if path[-1:] == ("[key]",):
        path = path[:-1]
    return f"{where(path)}: {key_text(path)} {_complaint(details)}."


def _complaint(details: ErrorDetails) -> str:
    kind, value = details["type"], details["input"]
    if kind == "extra_forbidden":
        return f"is unknown; allowed are {', '.join(_siblings(details['loc']))}"
    if kind == "missing":
        return "is missing"
    limits = details.get("ctx", {})
    wanted = _WANTED.get(kind)
    if kind == "string_too_short":
        least = limits["min_length"]
        wanted = f"text of {least} characters or more" if least > 1 else "some text"
    if kind == "string_pattern_mismatch":
        pattern = str(limits["pattern"])
        wanted = _PATTERNS.get(pattern, f"text that matches {pattern}")
    if wanted is None:
        message = details["msg"].removeprefix("Input should ").removeprefix("be ")
        wanted = message[0].lower() + message[1:]
    # The message may end up in a log, where a token must not be.
    is_secret = "token" in str(details["loc"][-1])
    shown = f"a text of {len(str(value))} characters" if is_secret else show(value)
    return f"is {shown}; it must be {wanted}"


def _siblings(path: tuple[str | int, ...]) -> list[str]:
    """Return the keys that are allowed in the place of an unknown key."""
    model: Any = StationConfig
    for part in path[:-1]:
        if get_origin(model) is dict:
            model = get_args(model)[1]
        else:
            model = model.model_fields[str(part)].annotation
    return [n for n, f in model.model_fields.items() if not f.exclude]
