"""Programs of aiofranka and of franka-rs, run by hand: no test has these packages.

In an environment with the client, against `station fci --desk`, and judged by Pinocchio
from the joints alone, in that of the station:

    python clients_by_hand.py aiofranka 127.0.0.1 | python clients_by_hand.py judge
"""

import json
import sys
import time

import numpy as np

HOME = [0.0, 0.0, 0.0, -1.57079, 0.0, 1.57079, -0.7853]


def tell(name, begin, end, **wanted):
    """Print where a motion began and ended, and where it should have ended."""
    values = {"begin": begin, "end": end, **wanted}
    line = {key: np.asarray(value, float).tolist() for key, value in values.items()}
    sys.stdout.write(json.dumps({"name": name, **line}) + "\n")


def aiofranka(host):
    """Unlock through Desk; moves, joint impedance, PID and OSC; lock."""
    import aiofranka

    aiofranka.unlock(host, username="admin", password="admin")
    robot = aiofranka.Robot(host)
    with aiofranka.Controller(robot) as controller:

        def follow(name, mode, target, goals, **wanted):
            controller.switch(mode)
            controller.set_freq(50)
            begin = robot.state["qpos"]
            for goal in goals:
                controller.set(target, goal)
            time.sleep(1.0)
            tell(name, begin, robot.state["qpos"], **wanted)

        begin, goal = robot.state["qpos"], [0.2, -0.3, 0.1, -1.9, 0.1, 1.7, -0.5]
        controller.move(goal)
        time.sleep(0.5)
        tell("move", begin, robot.state["qpos"], joints=goal)
        way = np.linspace(0.0, 1.0, 100)[:, None]
        for mode, turn in (("impedance", 0.1), ("pid", -0.05)):
            start = np.array(robot.state["qpos"])
            goals = start + way * turn * np.array([1, 0, 1, 1, 1, 1, 1])
            follow(mode, mode, "q_desired", goals, joints=goals[-1])
        start, shift = np.array(robot.state["ee"]), np.array([0.04, -0.05, 0.03])
        goals = [start.copy() for _ in way]
        for part, goal in zip(way, goals, strict=True):
            goal[:3, 3] += part * shift
        follow("osc", "osc", "ee_desired", goals, shift=shift)
        begin = robot.state["qpos"]
        controller.move(HOME)
        time.sleep(0.5)
        tell("home", begin, robot.state["qpos"], joints=HOME)
    robot.close()
    aiofranka.lock(host, username="admin", password="admin")


def franka_rs(host):
    """Joint and Cartesian targets, by its own torques and by the arm's controllers."""
    import franka

    robot = franka.Robot(host, realtime="ignore")
    robot.set_collision_behavior_simple([40.0] * 7, [40.0] * 7, [40.0] * 6, [40.0] * 6)
    sys.stdout.write(f"version {robot.fci_version}\n")
    turn = np.array([0.15, 0.1, -0.1, 0.2, 0.1, -0.15, 0.25])
    shift = np.array([0.04, -0.06, 0.03])
    for backend, sign in (("impedance", 1.0), ("robot", -1.0)):
        begin = np.array(robot.read_once().q)
        with robot.joint_targets(fraction=0.2, backend=backend) as arm:
            arm.move_to((begin + sign * turn).tolist())
            time.sleep(4.0)
            end = arm.state().q
        tell(f"joints, {backend}", begin, end, joints=begin + sign * turn)
        time.sleep(0.3)
        begin = np.array(robot.read_once().q)
        with robot.cartesian_targets(backend=backend) as arm:
            arm.move_by((sign * shift).tolist())
            time.sleep(4.0)
            end = arm.state().q
        tell(f"Cartesian, {backend}", begin, end, shift=sign * shift)
        time.sleep(0.3)


def judge():
    """Print how far Pinocchio finds joints and flange from where they belong."""
    import pinocchio as pin

    from station.core.description.robot_files import load_robot_files

    whole = pin.buildModelFromXML(load_robot_files("example-robot-data:panda").xml)
    fingers = [i for i, name in enumerate(whole.names) if "finger" in name]
    model = pin.buildReducedModel(whole, fingers, pin.neutral(whole))

    def flange(q):
        data = model.createData()
        pin.framesForwardKinematics(model, data, np.array(q))
        return data.oMf[model.getFrameId("panda_link8")].translation.copy()

    for line in sys.stdin:
        if not line.startswith("{"):
            sys.stdout.write(line)
            continue
        told = json.loads(line)
        end, said = flange(told["end"]), ""
        if joints := told.get("joints"):
            off = np.abs(np.subtract(told["end"], joints)).max()
            said, goal = f"joints off {1e3 * off:.2f} mrad, ", flange(joints)
        else:
            goal = flange(told["begin"]) + told["shift"]
        off = np.linalg.norm(end - goal)
        sys.stdout.write(f"{told['name']}: {said}flange off {1e3 * off:.2f} mm\n")


if __name__ == "__main__":
    what, *host = sys.argv[1:]
    {"aiofranka": aiofranka, "franka-rs": franka_rs, "judge": judge}[what](*host)
