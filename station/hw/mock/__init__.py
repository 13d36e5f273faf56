"""A robot without hardware that does what a script says."""

from station.hw.mock.mock_robot_hw import MockRobotHW as MockRobotHW
