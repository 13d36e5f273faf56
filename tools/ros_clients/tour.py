"""Drive a station by an unmodified roslibpy: what docs/ros_tools.md says of it.

By hand, in an environment of its own (`pip install roslibpy==2.1.0`), against
`station run --rosbridge`:

    python tools/ros_clients/tour.py ws://127.0.0.1:9090/?token=TOKEN
"""

import sys
import time

import roslibpy
from roslibpy.ros1 import actionlib

JOINTS = [f"panda_joint{number}" for number in range(1, 8)]
ARM = "effort_joint_trajectory_controller"
MANAGER, MESSAGES = "/controller_manager", "controller_manager_msgs"


class Tour:
    """One connection, and what is tried over it."""

    def __init__(self, url: str) -> None:
        self.ros = roslibpy.Ros(url)
        self.ros.run()

    def call(self, name: str, kind: str, /, **values: object) -> dict:
        """Call a service."""
        request = roslibpy.ServiceRequest(values)
        return roslibpy.Service(self.ros, name, kind).call(request)

    def controllers(self) -> None:
        """List, load, unload and switch controllers."""
        ros, call = self.ros, self.call
        print(len(ros.get_topics()), "topics,", len(ros.get_services()), "services")
        listed = call(f"{MANAGER}/list_controllers", f"{MESSAGES}/ListControllers")
        print([one["name"] for one in listed["controller"]])
        group = "position_controllers/JointGroupPositionController"
        ros.set_param("/toured", {"type": group, "joints": JOINTS})
        for verb in ("load", "unload"):
            kind = f"{MESSAGES}/{verb.title()}Controller"
            print(verb, call(f"{MANAGER}/{verb}_controller", kind, name="toured"))
        names = {"start_controllers": [ARM], "stop_controllers": [], "strictness": 2}
        kind = f"{MESSAGES}/SwitchController"
        print("switch", call(f"{MANAGER}/switch_controller", kind, **names))

    def joint_states(self) -> list[float]:
        """Receive joint states for three seconds; return the last positions."""
        states: list[dict] = []
        topic = roslibpy.Topic(self.ros, "/joint_states", "sensor_msgs/JointState")
        topic.subscribe(states.append)
        time.sleep(3.0)
        topic.unsubscribe()
        print(f"{len(states) / 3.0:.1f} joint states a second")
        return list(states[-1]["position"][:7])

    def actions(self, goal: list[float]) -> None:
        """Follow a trajectory by actionlib, and back by the operations of ROS 2."""
        server, feedback = f"/{ARM}/follow_joint_trajectory", []
        kind = "control_msgs/FollowJointTrajectoryAction"
        client = actionlib.ActionClient(self.ros, server, kind)
        one = actionlib.Goal(client, roslibpy.Message(_to([goal[0] + 0.2, *goal[1:]])))
        one.on("feedback", feedback.append)
        one.send()
        print("actionlib", one.wait(10), len(feedback), "times feedback")

        feedback, results = [], []
        kind = "control_msgs/action/FollowJointTrajectory"
        action = roslibpy.ActionClient(self.ros, server, kind)
        told = (results.append, feedback.append, results.append)
        action.wait_goal(action.send_goal(roslibpy.Goal(_to(goal)), *told), 10)
        print("ROS 2", results, len(feedback), "times feedback")

    def gain_and_stop(self) -> None:
        """Change a gain; stop, release and arm."""
        gains = {"doubles": [{"name": "p", "value": 550.0}]}
        service = f"/{ARM}/gains/panda_joint1/set_parameters"
        print(self.call(service, "dynamic_reconfigure/Reconfigure", config=gains))
        for name in ("/stop", "/stop/release", "/stop/arm"):
            print(name, self.call(name, "std_srvs/Trigger"))


def _to(positions: list[float]) -> dict:
    point = {"positions": positions, "time_from_start": {"secs": 2, "nsecs": 0}}
    return {"trajectory": {"joint_names": JOINTS, "points": [point]}}


if __name__ == "__main__":
    tour = Tour(sys.argv[1])
    tour.controllers()
    tour.actions(tour.joint_states())
    tour.gain_and_stop()
    tour.ros.terminate()
