"""The robot and the goals of the original's tests, on the mock with a stepped clock.

The robot's joints can be made sluggish, late by a cycle, or blocked by a wall.
"""

from math import inf, pi, remainder
from pathlib import Path

from typing_extensions import override

from station.app.composition import compose
from station.config import load_config
from station.core.clock import ManualClock
from station.core.control.switching import SwitchRequest
from station.core.ports.goal import Goal
from station.hw.mock import MockRobotHW

YAML = Path(__file__).parents[2] / "data" / "ros_yaml"
FOLDER = YAML / "joint_trajectory_controller"
JOINTS = ["joint1", "joint2"]
PERIOD = 0.01
EPS = 0.01
"""How exact the original wants desired and measured states to be [rad, rad/s …]."""
HOME = (1.0, [0.0, 0.0])
WAYPOINTS = [
    (1.0, [pi / 4, 0.0]),
    (2.0, [0.0, -pi / 4]),
    (4.0, [-pi / 4, pi / 4]),
]
END = WAYPOINTS[-1][1]
# Nobody cares for the error on the way.
ANY_PATH = [{"name": name, "position": -1.0, "velocity": -1.0} for name in JOINTS]
TWO_JOINTS = """
station: {rate: 100}
robot: {type: "tests.controllers.joint_trajectory_controller.rrbot:ROBOT"}
api: {port: 0}
"""


class RRBotHW(MockRobotHW):
    """The mock, with joints that may lag behind.

    Attributes:
        smoothing: Part of each joint's way that is not gone in a cycle, 0 to 1.
        is_late: Whether commands take effect one cycle later.
        upper_bound: Where a wall is [rad].
    """

    def __init__(self):
        super().__init__()
        self.smoothing = [0.0, 0.0]
        self.is_late = False
        self.upper_bound = inf
        self._last = [[0.0, 0.0] for _ in range(3)]

    @override
    def init(self, root_params, hw_params):
        super().init(root_params, hw_params)
        root_params.set("robot_description", (YAML / "rrbot.urdf").read_text())

    @override
    def write(self, time, period):
        joints = self.joints
        self._delay(
            joints.position_command, joints.velocity_command, joints.effort_command
        )
        super().write(time, period)

    @override
    def read(self, time, period):
        before = list(self.joints.position)
        super().read(time, period)
        if period > 0.0:
            self.move(before)
            super().read(time, 0.0)  # measure the joints where they are now

    def move(self, before):
        """Let the joints lag behind their commands.

        Args:
            before: Positions at the beginning of the cycle [rad], shape (2,).
        """
        joints = self.joints
        for index, part in enumerate(self.smoothing):
            way = joints.position[index] - before[index]
            joints.position[index] = before[index] + (1.0 - part) * way
            joints.velocity[index] *= 1.0 - part
            if joints.position[index] > self.upper_bound:
                joints.position[index] = self.upper_bound
                joints.velocity[index] = 0.0

    def _delay(self, *commands):
        for index, command in enumerate(commands):
            newest = list(command)
            if self.is_late:
                command[:] = self._last[index]
            self._last[index] = newest


class WrappingRRBotHW(RRBotHW):
    """Joints whose sensors know a turn only, from -pi to pi."""

    @override
    def move(self, before):
        super().move(before)
        position = self.joints.position
        position[:] = [remainder(value, 2.0 * pi) for value in position]


def trajectory(*points, joints=JOINTS, stamp=0.0):
    """Return a message with rests at the points (time_from_start, positions)."""
    rest = [0.0] * len(joints)
    return {
        "header": {"stamp": stamp},
        "joint_names": list(joints),
        "points": [
            {
                "time_from_start": time,
                "positions": positions,
                "velocities": rest,
                "accelerations": rest,
            }
            for time, positions in points
        ],
    }


def robot_of(kind):
    """Return a configuration of a station with the robot of that class."""
    return TWO_JOINTS.replace("ROBOT", kind.__name__)


class RRBot:
    """A station whose controller was loaded from a parameter file of the original.

    Args:
        folder: Where the station's own file may be written.
        file: The parameter file.
        robot: Class of the robot.
        changes: Parameters that are set instead of those of the file, by path.
    """

    def __init__(self, folder, file, robot=RRBotHW, **changes):
        path = folder / "station.yaml"
        path.write_text(robot_of(robot))
        config = load_config(path, controller_files=[file])
        composition = compose(config, ManualClock())
        assert not composition.not_loaded
        self.station = composition.station
        self.hw = self.station.loop.hw
        (self.name,) = config.controllers
        self.stop_duration = config.controller_parameters()[self.name].get(
            "stop_trajectory_duration", 0.0
        )
        if changes:
            self.reload(**changes)
        else:
            self.start()

    def start(self):
        """Start the controller and run a few cycles."""
        assert self.station.switch_controllers(SwitchRequest(start=(self.name,))).ok
        self.run(0.05)

    def reload(self, **changes):
        """Load the controller anew with other parameters, and start it."""
        self.station.switch_controllers(SwitchRequest(stop=(self.name,)))
        self.station.unload_controller(self.name)
        for path, value in changes.items():
            self.station.parameters.set(f"{self.name}/{path}", value)
        self.station.load_controller(self.name)
        self.start()

    def send(self, *points, joints=JOINTS, stamp=0.0, **fields) -> Goal:
        """Send a goal, as the action's client does."""
        message = trajectory(*points, joints=joints, stamp=stamp)
        return self.station.motion.submit_goal(
            self.name, {"trajectory": message, **fields}
        )

    def publish(self, *points, joints=JOINTS, stamp=0.0):
        """Send a trajectory to the topic."""
        message = trajectory(*points, joints=joints, stamp=stamp)
        self.station.motion.follow_trajectory(self.name, message)

    def run(self, seconds):
        """Let time pass."""
        self.station.loop.step(round(seconds / PERIOD))

    def finish(self, goal, seconds=6.0):
        """Let time pass until a goal has ended, and some time to settle."""
        for _ in range(round(seconds / PERIOD)):
            if goal.is_final():
                break
            self.run(PERIOD)
        else:
            raise AssertionError(f"the goal is {goal.status} after {seconds} s")
        self.run(0.5)

    @property
    def now(self):
        """Station time [s]."""
        return self.station.loop.time

    def state(self):
        """Return the message of the topic `state`."""
        return self.station.published(self.name)["state"]

    def desired(self):
        """Return desired positions [rad]."""
        return self.state()["desired"]["positions"]

    def is_at(self, positions, eps=EPS):
        """Say whether the joints shall be and are at rest at these positions."""
        state = self.state()
        wanted, actual = state["desired"], state["actual"]
        return all(
            abs(value - expected) < eps
            for values, due in (
                (wanted["positions"], positions),
                (actual["positions"], positions),
                (wanted["velocities"], [0.0, 0.0]),
                (actual["velocities"], [0.0, 0.0]),
                (wanted["accelerations"], [0.0, 0.0]),
            )
            for value, expected in zip(values, due, strict=True)
        )

    def stands(self):
        """Say whether the joints stand and shall stand."""
        return self.is_at(self.state()["actual"]["positions"])
