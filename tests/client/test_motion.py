"""Motions in one call, and which controllers are in their way."""

import asyncio

import pytest

from station.client import (
    AsyncStationClient,
    MotionError,
    Pose,
    UnknownPoseError,
    motion,
)
from station.client.motion import in_the_way
from station.wire import (
    ClaimedResources,
    CommandAccepted,
    ControllerSample,
    ControllerState,
    DesiredState,
    Goal,
)

JOINTS = [f"panda_joint{number}" for number in range(1, 8)]
TRAJECTORY = "position_controllers/JointTrajectoryController"
CARTESIAN = "franka_controllers/CartesianStreamingController"
CLAIMS = {"arm": JOINTS, "hand": ["panda_robot"], "group": JOINTS}
HERE = (0.3, 0.0, 0.5, 1.0, 0.0, 0.0, 0.0)


class FakeStation(AsyncStationClient):
    """A station whose end effector makes one step per set-point."""

    def __init__(self, **states):
        super().__init__("http://a", "t")
        self.states = states
        self.calls = []
        self.pose = list(HERE)
        self.obstacle = "none"

    async def controllers(self):
        """Return the controllers."""
        kinds = {"arm": TRAJECTORY, "hand": CARTESIAN, "group": "a/B"}
        return [
            ControllerState.model_construct(
                name=n,
                type=kinds[n],
                state=s,
                claimed_resources=[
                    ClaimedResources(hardware_interface="i", resources=CLAIMS[n])
                ],
            )
            for n, s in self.states.items()
        ]

    async def switch_controllers(self, start=(), stop=()):
        """Keep the request."""
        self.calls.append(("switch", list(start), list(stop)))

    async def query_state(self, name):
        """Return where the joints are wanted."""
        zeros = [0.0] * 7
        return DesiredState(
            name=JOINTS, position=zeros, velocity=zeros, acceleration=zeros
        )

    async def submit_goal(self, name, goal, epoch=None, certificate=None):
        """Keep the goal."""
        self.calls.append(("goal", name, goal["trajectory"]["points"][0]))
        return Goal.model_construct(id="1", status="succeeded")

    async def command(self, name, values, *, timeout):
        """Go a third of the way."""
        self.calls.append(("command", name, list(values), timeout))
        if self.obstacle == "none":
            self.pose = list(values)
        return CommandAccepted(epoch=1)

    async def controller_state(self, name):
        """Return the pose."""
        return ControllerSample(
            stamp=0.0,
            name=list("xyzabcd"),
            desired=list(HERE),
            actual=self.pose,
            error=[],
            output=[],
            published={"state": {"obstacle": self.obstacle, "message": "A wall."}},
        )


@pytest.fixture(autouse=True)
def clock(monkeypatch):
    """Let waiting pass time at once."""
    now = [100.0]

    async def sleep(seconds):
        now[0] += seconds

    monkeypatch.setattr(asyncio, "sleep", sleep)
    monkeypatch.setattr(motion.time, "monotonic", lambda: now[0])


def test_named_pose_takes_the_joints_over_from_whoever_holds_them():
    station = FakeStation(arm="initialized", group="running")

    asyncio.run(station.move_to("ready"))

    assert station.calls[0] == ("switch", ["arm"], ["group"])
    name, controller, point = station.calls[1]
    assert (name, controller) == ("goal", "arm")
    assert point["positions"][3] == pytest.approx(-2.356, abs=1e-3)
    assert point["time_from_start"] == pytest.approx(2.356194 / 0.5)


def test_torques_beside_a_running_motion_are_stopped():
    station = FakeStation(arm="running", group="running")

    asyncio.run(station.move_to("ready"))

    assert station.calls[0] == ("switch", [], ["group"])


def test_joints_that_are_not_named_stay():
    station = FakeStation(arm="running")

    asyncio.run(station.move_to({"panda_joint2": 0.5}, duration=2.0))

    ((_, _, point),) = station.calls
    assert point["positions"] == [0.0, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0]
    assert point["time_from_start"] == 2.0


@pytest.mark.parametrize(
    ("target", "reason"),
    [
        ([1.0, 2.0], "2 positions were given for 7 joints"),
        ({"elbow": 1.0}, "There is no joint 'elbow'"),
    ],
)
def test_wrong_joints_are_refused(target, reason):
    with pytest.raises(MotionError, match=reason):
        asyncio.run(FakeStation(arm="running").move_to(target))


def test_unknown_pose_is_refused_before_anything_is_started():
    station = FakeStation(arm="initialized")

    with pytest.raises(UnknownPoseError, match="There is no pose 'kitchen'"):
        asyncio.run(station.move_to("kitchen"))

    assert station.calls == []


def test_without_a_controller_for_it_the_refusal_says_what_to_load():
    with pytest.raises(MotionError, match="No JointTrajectoryController is loaded"):
        asyncio.run(FakeStation(group="running").move_to("ready"))


def test_end_effector_keeps_its_orientation():
    station = FakeStation(hand="running")

    asyncio.run(station.move_to(Pose((0.4, 0.1, 0.5))))

    target = [0.4, 0.1, 0.5, *HERE[3:]]
    assert station.calls == [("command", "hand", target, motion.HEARTBEAT)]


def test_opposite_quaternion_is_the_same_orientation():
    station = FakeStation(hand="running")

    asyncio.run(station.move_to(Pose((0.3, 0.0, 0.5), (-1.0, 0.0, 0.0, 0.0))))

    assert station.calls == []


def test_obstacle_ends_the_motion_with_its_message():
    station = FakeStation(hand="running")
    station.obstacle = "singularity"

    with pytest.raises(MotionError, match=r"cannot get there\. A wall"):
        asyncio.run(station.move_to(Pose((2.0, 0.0, 0.5))))


def test_motion_that_takes_too_long_is_given_up(monkeypatch):
    station = FakeStation(hand="running")
    monkeypatch.setattr(motion, "BLOCKED", 99.0)
    station.obstacle = "joint_speed"

    with pytest.raises(MotionError, match="did not arrive within 3 s"):
        asyncio.run(station.move_to(Pose((2.0, 0.0, 0.5)), timeout=3))


def test_motion_to_a_pose_takes_no_duration():
    with pytest.raises(ValueError, match="takes no duration"):
        asyncio.run(FakeStation().move_to(Pose((0.4, 0.1, 0.5)), duration=1.0))


RUNNING = {
    "torques": ("panda_joint1", "panda_joint2"),
    "pose": ("panda_robot",),
    "fingers": ("panda_finger_joint1",),
    "other": ("left_joint1",),
    "states": (),
}


@pytest.mark.parametrize(
    ("wanted", "found"),
    [
        (["panda_joint1"], ["torques", "pose"]),
        (["panda_robot"], ["torques", "pose"]),
        (["panda_finger_joint1"], ["fingers"]),
        (["left_robot"], ["other"]),
        ([], []),
    ],
)
def test_controllers_of_the_same_joints_are_found(wanted, found):
    assert in_the_way(wanted, RUNNING) == found
