"""The storm: every operation at once, against a robot and its controllers."""

from station.testing.storm.storm import storm as storm
from station.testing.storm.storm_report import StormReport as StormReport
