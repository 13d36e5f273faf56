"""Several robots as one, made from the types that the station knows."""

from station.core.hardware import combined_robot_hw
from station.hw.robot_loader import create_robot


class CombinedRobotHW(combined_robot_hw.CombinedRobotHW):
    """Type `combined_robot_hw/CombinedRobotHW` of the configuration."""

    def __init__(self) -> None:
        super().__init__(create_robot)
