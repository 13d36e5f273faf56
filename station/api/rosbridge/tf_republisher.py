"""Compute transforms between any two frames, for clients without a tree of transforms.

Source: RobotWebTools/tf2_web_republisher, tf_web_republisher.cpp; differs: a topic ends
10 s after its last subscriber has left; the time-out of the request is ignored.
"""

from collections.abc import Callable, Iterator
from itertools import count
from math import acos
from time import monotonic

from station.api.rosbridge.actions import Action, Progress, Running
from station.api.rosbridge.ros_types import RosTypeError
from station.api.rosbridge.services import RosService
from station.api.rosbridge.topics import CycleFrame, StationTopics, Topic
from station.api.tool_port import ToolClient
from station.core.description.urdf import Pose, Urdf
from station.core.ports.goal import GoalStatus
from station.records.cdr import Values
from station.records.messages import joint_pose, joint_position, stamped_transform

MOST_WATCHES = 64
"""Most topics and goals for which transforms are computed."""
_KEPT = 10.0
_NAME = "/tf2_web_republisher"


class TfRepublisher:
    """Computes transforms for topics and goals of clients.

    Args:
        urdf: The robot.
        clock: The station's topics, which make the messages of cycles.
        add: Function that adds a new topic.
    """

    def __init__(
        self,
        urdf: Urdf,
        clock: StationTopics,
        add: Callable[[Topic], object],
    ) -> None:
        self._joints = {joint.child: joint for joint in urdf.joints.values()}
        self._clock = clock
        self._add = add
        self._topics: dict[str, tuple[Topic, list[float]]] = {}
        self._goals = 0
        self._numbers = count(1)
        self.action = Action(
            _NAME, "tf2_web_republisher/TFSubscription", self._begin, changes=False
        )
        self.service = RosService(
            "/republish_tfs",
            "tf2_web_republisher/RepublishTFs",
            self._republish,
            blocks=False,
        )

    def topics(self) -> Iterator[Topic]:
        """Yield the topics that a client reads or has just requested."""
        oldest = monotonic() - _KEPT
        known = self._topics.items()
        self._topics = {name: one for name, one in known if one[1][0] > oldest}
        yield from (topic for topic, _ in self._topics.values())

    def _republish(self, _: ToolClient, request: Values) -> Values:
        watch, name = self._watch(request), f"/tf_repub_{next(self._numbers)}"
        used = [monotonic()]

        def read(frame: CycleFrame) -> Values | None:
            used[0] = monotonic()
            found = watch(frame)
            return {"transforms": found} if found else None

        topic = Topic(name, "tf2_web_republisher/TFArray", read, in_pause=True)
        self._topics[name] = (topic, used)
        self._add(topic)
        return {"topic_name": name}

    def _begin(self, _: ToolClient, goal: Values) -> Running:
        watch, state = self._watch(goal), [GoalStatus.ACTIVE]
        self._goals += 1

        def poll() -> Progress:
            frame = self._clock.frame()
            found = [] if frame is None else watch(frame)
            return Progress(state[0], {"transforms": found} if found else {})

        def cancel() -> None:
            self._goals -= state[0] is GoalStatus.ACTIVE
            state[0] = GoalStatus.PREEMPTED

        return Running(poll, cancel)

    def _watch(self, wanted: Values) -> Callable[[CycleFrame], list[Values]]:
        """Return a function that computes changed transforms, at the requested rate.

        Raises:
            RosTypeError: The rate is not positive, or there are too many topics and
                goals.
        """
        if not wanted["rate"] > 0.0:
            raise RosTypeError(f"'rate' is {wanted['rate']}; it must be above 0.")
        if self._goals + len(list(self.topics())) >= MOST_WATCHES:
            raise RosTypeError(f"{MOST_WATCHES} lists of transforms are sent already.")
        target = wanted["target_frame"].strip("/")
        sources = [name.strip("/") for name in wanted["source_frames"]]
        sent: dict[str, Pose] = {}
        due = [0.0]

        def watch(frame: CycleFrame) -> list[Values]:
            now = monotonic()
            found: list[Values] = []
            if now < due[0]:
                return found
            due[0] = now + 1.0 / wanted["rate"] - 0.005
            for source in sources:
                pose = self._between(target, source, frame)
                if pose is None or not _has_changed(sent.get(source), pose, wanted):
                    continue
                sent[source] = pose
                found.append(stamped_transform(target, source, pose, frame.stamp))
            return found

        return watch

    def _between(self, target: str, source: str, frame: CycleFrame) -> Pose | None:
        """Return the pose of a frame in another one; None if nothing connects them."""
        if target == source:
            return Pose()
        positions = self._clock.positions(frame)
        (root, pose), (other, inner) = (
            self._from_root(name, positions) for name in (target, source)
        )
        return pose.inverse().compose(inner) if root == other else None

    def _from_root(self, name: str, positions: dict[str, float]) -> tuple[str, Pose]:
        pose = Pose()
        while name in self._joints:
            joint = self._joints[name]
            position = joint_position(joint, positions)
            name, pose = joint.parent, joint_pose(joint, position).compose(pose)
        return name, pose


def _has_changed(old: Pose | None, new: Pose, wanted: Values) -> bool:
    if old is None:
        return True
    step = old.inverse().compose(new)
    angle = 2.0 * acos(min(1.0, abs(step.quaternion[0])))
    distance = sum(part**2 for part in step.xyz) ** 0.5
    return bool(angle > wanted["angular_thres"] or distance > wanted["trans_thres"])
