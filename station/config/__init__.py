"""The station's configuration: YAML files and the environment, validated."""

from station.config.loading import load_config as load_config
from station.config.models import StationConfig as StationConfig
from station.core.errors import ConfigError as ConfigError
