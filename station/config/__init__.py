"""The station's configuration: YAML files and the environment, validated."""

from station.config.loading import load_config
from station.config.models import ApiSection, LoopSection, StationConfig, UiSection
from station.core.config_error import ConfigError

__all__ = [
    "ApiSection",
    "ConfigError",
    "LoopSection",
    "StationConfig",
    "UiSection",
    "load_config",
]
