"""A program of panda-python, unmodified libfranka inside; prints what it saw as JSON.

Usage: python panda_client.py HOST SCENARIO...
"""

import json
import sys
import time

import numpy as np
import panda_py
from panda_py import controllers, libfranka

STIFF = np.diag([600.0] * 3 + [30.0] * 3)


def connect(panda, _host):
    """Read the state and the model."""
    state, model = panda.get_state(), panda.get_model()
    pose = model.pose(libfranka.Frame.kEndEffector, state)
    return {
        "version": panda.get_robot().server_version(),
        "q": list(state.q),
        "pose": list(state.O_T_EE),
        "pose_of_model": list(pose),
        "gravity": list(model.gravity(state)),
        "mode": str(state.robot_mode),
    }


def joint_motion(panda, _host):
    """Move two joints, there and back."""
    start = panda.q
    goal = start + np.array([0.2, 0.1, 0, 0, 0, 0, -0.2])
    arrived = panda.move_to_joint_position(goal, speed_factor=0.8)
    error = float(np.abs(panda.q - goal).max())
    return {
        "arrived": arrived,
        "error": error,
        "back": panda.move_to_joint_position(start, speed_factor=0.8),
    }


def pose_motion(panda, _host):
    """Move the hand up, and back."""
    start = panda.get_pose()
    goal = start.copy()
    goal[2, 3] += 0.05
    arrived = panda.move_to_pose([goal], speed_factor=0.8)
    error = float(np.abs(panda.get_position() - goal[:3, 3]).max())
    back = panda.move_to_pose([start], speed_factor=0.8)
    return {"arrived": arrived, "error": error, "back": back}


def joint_impedance(panda, _host):
    """Hold joints 5 cm of arc aside with the impedance controller."""
    goal = panda.q + np.array([0, 0, 0, 0, 0.05, 0, 0.05])
    controller = controllers.JointPosition(filter_coeff=0.02)
    panda.start_controller(controller)
    controller.set_control(goal)
    time.sleep(1.0)
    error = float(np.abs(panda.q - goal).max())
    panda.stop_controller()
    return {"error": error, "mode": str(panda.get_robot().read_once().robot_mode)}


def cartesian_impedance(panda, _host):
    """Hold the hand 2 cm higher with the impedance controller."""
    position, orientation = panda.get_position(), panda.get_orientation()
    goal = position + np.array([0.0, 0.0, 0.02])
    controller = controllers.CartesianImpedance(impedance=STIFF, filter_coeff=0.02)
    panda.start_controller(controller)
    controller.set_control(goal, orientation)
    time.sleep(1.2)
    error = float(np.abs(panda.get_position() - goal).max())
    panda.stop_controller()
    return {"error": error}


def integrated_velocity(panda, _host):
    """Turn joint 7 at 0.1 rad/s; the controller says how far it wanted to come."""
    start = panda.q
    controller = controllers.IntegratedVelocity()
    panda.start_controller(controller)
    controller.set_control([0, 0, 0, 0, 0, 0, 0.1])
    time.sleep(0.7)
    controller.set_control([0.0] * 7)
    time.sleep(0.4)
    wanted, q = np.array(controller.get_qd()), panda.q
    panda.stop_controller()
    return {
        "turned": float(q[6] - start[6]),
        "error": float(np.abs(q - wanted).max()),
    }


def gripper(_panda, host):
    """Move the fingers, and grasp air."""
    hand = libfranka.Gripper(host)
    before = hand.read_once().width
    moved = hand.move(0.05, 0.2)
    time.sleep(0.1)
    width = hand.read_once().width
    grasped = hand.grasp(0.03, 0.3, 20.0, 0.005, 0.005)
    return {
        "before": before,
        "moved": moved,
        "width": width,
        "grasped": grasped,
        "stopped": hand.stop(),
    }


def collision(panda, _host):
    """Push into the table, recover, and move away."""
    robot = panda.get_robot()
    start, q_start = panda.get_pose(), panda.q
    goal = start.copy()
    goal[2, 3] -= 0.12
    said, arrived = "", None
    try:
        arrived = panda.move_to_pose([goal], speed_factor=0.3)
        panda.raise_error()
    except RuntimeError as error:
        said = str(error)
    after = robot.read_once()
    panda.recover()
    recovered = robot.read_once()
    return {
        "arrived": arrived,
        "said": said,
        "mode": str(after.robot_mode),
        "errors": repr(after.last_motion_errors),
        "recovered": str(recovered.robot_mode),
        "back": panda.move_to_joint_position(q_start, speed_factor=0.3),
    }


def main(host, names):
    """Run the scenarios one after the other."""
    panda = panda_py.Panda(host)
    found = {name: globals()[name](panda, host) for name in names}
    sys.stdout.write(json.dumps(found))


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
