"""A robot without hardware that follows a script."""

from station.hw.mock.mock_robot_hw import MockRobotHW as MockRobotHW
