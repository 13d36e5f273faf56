"""The configuration of a trial as text, so that it can travel and be compared."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Self

from station.config import StationConfig, load_config
from station.config.models import Controller

_NOT_OF_A_TRIAL = ("api", "ui", "watchdog")
"""Sections that serve and draw. They stay at their defaults: a trial has neither, and
the token of a server must not travel or be stored with results."""


@dataclass(frozen=True)
class Setup:
    """A station's whole configuration, with the files that it named read in.

    Paths of URDFs and meshes stay paths: every machine that runs trials needs them.

    Args:
        text: The configuration as canonical JSON; `load` makes it.
    """

    text: str

    @classmethod
    def load(
        cls,
        config: Path | str | Mapping[str, object] | None = None,
        *,
        controllers: Sequence[Path | str] = (),
        settings: Mapping[str, object] | None = None,
    ) -> Self:
        """Return the setup of a configuration; the arguments are `station.open`'s.

        Raises:
            ConfigError: A file cannot be read, or a value is not allowed.
        """
        loaded = load_config(
            Path(config) if isinstance(config, str) else config,
            controller_files=[Path(file) for file in controllers],
            flags=settings,
        )
        return cls.of(loaded)

    @classmethod
    def of(cls, config: StationConfig) -> Self:
        """Return the setup of a configuration that is loaded already."""
        values = config.model_dump(mode="json", exclude=set(_NOT_OF_A_TRIAL))
        values["parameters"] = config.parameters
        return cls(canonical(values))

    def with_controllers(self, loaded: Mapping[str, Mapping[str, object]]) -> Self:
        """Return the setup with the controllers that a station has loaded.

        Args:
            loaded: Their parameters by name, `type` among them. They replace those of
                the configuration that have the same name.
        """
        values = json.loads(self.text)
        values["controllers"] = {
            **values.get("controllers", {}),
            # As a configuration with these controllers would have them.
            **{
                name: Controller.model_validate(parameters).model_dump(mode="json")
                for name, parameters in loaded.items()
            },
        }
        return replace(self, text=canonical(values))

    @cached_property
    def digest(self) -> str:
        """Name of the setup: 16 hexadecimal digits."""
        return digest_of(self.text)

    def config(self) -> StationConfig:
        """Return the configuration."""
        defaults = load_config().model_dump(mode="json", include=set(_NOT_OF_A_TRIAL))
        return StationConfig.model_validate({**defaults, **json.loads(self.text)})


def canonical(data: object) -> str:
    """Return the one JSON text of some data: sorted keys, no blanks.

    Raises:
        ValueError: A number is not finite.
    """
    return json.dumps(data, sort_keys=True, separators=(",", ":"), allow_nan=False)


def digest_of(text: str) -> str:
    """Return the first 16 hexadecimal digits of the SHA-256 of a text."""
    return hashlib.sha256(text.encode()).hexdigest()[:16]
