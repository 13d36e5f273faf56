"""Stations as Gymnasium environments: `gymnasium.make("station.gym:Station-v0")`.

Importing this package registers the environment; it needs the extra `gym`.
"""

import gymnasium

from station.gym.station_env import StationEnv as StationEnv

gymnasium.register("Station-v0", entry_point="station.gym.station_env:StationEnv")
