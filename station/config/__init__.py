"""The station's configuration: YAML files and the environment, validated."""

from station.config.errors import ConfigError
from station.config.loading import load_config
from station.config.models import ApiSection, LoopSection, StationConfig, UiSection

__all__ = [
    "ApiSection",
    "ConfigError",
    "LoopSection",
    "StationConfig",
    "UiSection",
    "load_config",
]
