"""The storm: every operation at once, against a robot and its controllers."""

from station.testing.storm.storm import Fault, storm
from station.testing.storm.storm_report import StormReport

__all__ = ["Fault", "StormReport", "storm"]
