"""Load parameters out of YAML files and write them into one, as `rosparam` does."""

from pathlib import Path

import yaml

from station.core.parameters import Parameters
from station.core.yaml_reader import parse_yaml, read_yaml


def load_parameters(params: Parameters, path: Path) -> None:
    """Merge the YAML file at `path` into a namespace, value by value.

    Other values of the namespace stay. Listeners are notified of every value.

    Args:
        params: The namespace.
        path: The file.

    Raises:
        ConfigError: The file cannot be read or is not valid; nothing changed.
    """
    _merge(params, "", read_yaml(path).values)


def load_parameters_text(params: Parameters, text: str, name: str) -> None:
    """Merge YAML text into a namespace; see `load_parameters`.

    Args:
        params: The namespace.
        text: The YAML text.
        name: Stands for the file in messages.

    Raises:
        ConfigError: The text is not valid; nothing changed.
    """
    _merge(params, "", parse_yaml(text, name).values)


def dump_parameters(params: Parameters) -> str:
    """Return a namespace as YAML text that `load_parameters` reads back the same.

    Args:
        params: The namespace.
    """
    values = params.get()
    if not isinstance(values, dict) or not values:
        return "{}\n"
    return yaml.dump(values, Dumper=_Dumper, sort_keys=False, allow_unicode=True)


class _Dumper(yaml.SafeDumper):
    """Write numbers so that every YAML reader recognises them as numbers."""


def _represent_float(dumper: yaml.SafeDumper, value: float) -> yaml.ScalarNode:
    if value != value or value in {float("inf"), float("-inf")}:
        return dumper.represent_float(value)
    text = repr(value)
    if "e" in text and "." not in text:
        text = text.replace("e", ".0e")  # YAML 1.1 takes 1e-3 for text
    return dumper.represent_scalar("tag:yaml.org,2002:float", text)


_Dumper.add_representer(float, _represent_float)


def _merge(params: Parameters, path: str, value: object) -> None:
    if not isinstance(value, dict) or not value:
        if path:
            params.set(path, value)
        return
    for key, child in value.items():
        _merge(params, f"{path}/{key}", child)
