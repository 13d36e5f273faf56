"""Settings from the environment: `STATION_API__PORT=8001` is `api: {port: 8001}`."""

from collections.abc import Iterator

from pydantic import Field
from pydantic_settings import BaseSettings, SettingsConfigDict, SettingsError

from station.core.config_error import ConfigError
from station.core.yaml_reader import KeyPath, parse_value

_PREFIX = "STATION_"
_BETWEEN = "__"
_Section = dict[str, object]


class _Environment(BaseSettings):
    """The sections, which map variables to keys; values are read as YAML."""

    model_config = SettingsConfigDict(
        env_prefix=_PREFIX, env_nested_delimiter=_BETWEEN, extra="ignore"
    )

    station: _Section = Field(default_factory=dict)
    robot: _Section = Field(default_factory=dict)
    controllers: _Section = Field(default_factory=dict)
    start: list[str] | None = None
    api: _Section = Field(default_factory=dict)
    ui: _Section = Field(default_factory=dict)
    records: _Section = Field(default_factory=dict)
    foxglove: _Section = Field(default_factory=dict)


def read_environment() -> Iterator[tuple[KeyPath, object, str]]:
    """Yield each setting of the environment: its path, its value, its variable.

    Raises:
        ConfigError: A variable for a list or mapping is not JSON.
    """
    try:
        settings = _Environment().model_dump(exclude_unset=True)
    except (SettingsError, ValueError) as error:
        raise ConfigError(
            [f"Environment variables {_PREFIX}…: {error}."],
            remedy=f"Write lists and mappings as JSON: {_PREFIX}START='[\"arm\"]'.",
        ) from error
    yield from _leaves(settings, ())


def _leaves(
    node: dict[str, object], path: KeyPath
) -> Iterator[tuple[KeyPath, object, str]]:
    for key, value in node.items():
        here = (*path, key)
        if isinstance(value, dict):
            yield from _leaves(value, here)
        else:
            variable = _PREFIX + _BETWEEN.join(map(str, here)).upper()
            if isinstance(value, str):
                value = parse_value(value, f"environment variable {variable}")
            yield here, value, variable
