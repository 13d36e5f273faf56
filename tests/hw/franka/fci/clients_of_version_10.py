"""Programs of pylibfranka and of franky, unmodified; prints what they saw as JSON.

Usage: python clients_of_version_10.py HOST pylibfranka|franky
"""

import json
import math
import sys
import time

import numpy as np

LASTING = 1.0
"""Duration of each motion of `pylibfranka` [s]."""
TURN = [0.0, 0.0, 0.05, 0.0, 0.08, 0.0, 0.1]
"""How far franky's springs turn the joints, and torques turn them back [rad]."""
ASIDE = [0.3, -0.6, 0.2, -2.0, 0.1, 1.8, 0.5]


class Pylibfranka:
    """The maker's own Python binding, which asks for version 10.

    Args:
        host: Address of the arm.
    """

    def __init__(self, host):
        import pylibfranka

        self._f = pylibfranka
        self._robot = pylibfranka.Robot(host, pylibfranka.RealtimeConfig.kIgnore)
        self._model = self._robot.load_model()

    def run(self):
        """Return what each scenario saw."""
        f, robot = self._f, self._robot
        mode = f.ControllerMode.JointImpedance
        state = robot.read_once()
        seen = {
            "connect": {
                "q": list(state.q),
                "gravity": list(self._model.gravity(state)),
                "mass": list(self._model.mass(state)),
            },
            "positions": self._move(
                robot.start_joint_position_control(mode), self._positions
            ),
            "velocities": self._move(
                robot.start_joint_velocity_control(mode), self._velocities
            ),
            "pose": self._move(robot.start_cartesian_pose_control(mode), self._pose),
            "twist": self._move(
                robot.start_cartesian_velocity_control(mode), self._twist
            ),
            "torques": self._move(robot.start_torque_control(), self._torques),
            "asynchronous": self._asynchronous(),
        }
        seen["jump"] = self._jump()
        return seen

    def _move(self, control, command):
        """Return where a motion begins and ends, and the state's modes within."""
        begin, _ = control.readOnce()
        state, t = begin, 0.0
        while t < LASTING:
            t += 0.001
            one = command(begin, state, min(t, LASTING))
            one.motion_finished = t >= LASTING
            control.writeOnce(one)
            if t < LASTING:
                state, _ = control.readOnce()
        end = self._robot.read_once()
        return {
            "begin": list(begin.q_d),
            "end": list(end.q),
            "mode": str(end.robot_mode).rpartition(".")[2],
            "within": str(state.robot_mode).rpartition(".")[2],
        }

    @staticmethod
    def _share(t):
        return (1.0 - math.cos(math.pi * t / LASTING)) / 2.0

    @staticmethod
    def _rate(t):
        return math.pi / LASTING * math.sin(math.pi * t / LASTING) / 2.0

    def _positions(self, begin, _state, t):
        q = list(begin.q_d)
        q[3] += 0.2 * self._share(t)
        q[5] -= 0.2 * self._share(t)
        return self._f.JointPositions(q)

    def _velocities(self, _begin, _state, t):
        return self._f.JointVelocities([0.0] * 3 + [-0.2 * self._rate(t)] + [0.0] * 3)

    def _pose(self, begin, _state, t):
        pose = list(begin.O_T_EE_d)
        pose[14] -= 0.05 * self._share(t)
        return self._f.CartesianPose(pose)

    def _twist(self, _begin, _state, t):
        return self._f.CartesianVelocities([0, 0, 0.05 * self._rate(t), 0, 0, 0])

    def _torques(self, begin, state, t):
        error = np.array(begin.q_d) - np.array(state.q)
        torques = 200.0 * error - 20.0 * np.array(state.dq)
        torques[4:] /= 4.0
        return self._f.Torques(list(torques * min(1.0, 4.0 * t)))

    def _asynchronous(self):
        handlers = self._f.AsyncPositionControlHandler
        begun = handlers.configure(
            self._robot, handlers.Configuration([0.8] * 7, 0.001)
        )
        handler = begun.handler
        target = handlers.JointPositionTarget(joint_positions=ASIDE)
        handler.set_joint_position_target(target)
        deadline = time.monotonic() + 30.0
        status = "kExecuting"
        while status == "kExecuting" and time.monotonic() < deadline:
            time.sleep(0.01)
            status = str(handler.get_target_feedback().status).rpartition(".")[2]
        handler.stop_control()
        return {"status": status, "end": list(self._robot.read_once().q)}

    def _jump(self):
        control = self._robot.start_joint_position_control(
            self._f.ControllerMode.JointImpedance
        )
        state, _ = control.readOnce()
        q = [state.q_d[0] + 0.3, *list(state.q_d)[1:]]
        said = ""
        try:
            for _ in range(50):
                control.writeOnce(self._f.JointPositions(q))
                control.readOnce()
        except self._f.ControlException as error:
            said = str(error)
        before = str(self._robot.read_once().robot_mode).rpartition(".")[2]
        self._robot.automatic_error_recovery()
        deadline = time.monotonic() + 5.0
        while time.monotonic() < deadline:
            mode = str(self._robot.read_once().robot_mode).rpartition(".")[2]
            if mode == "Idle":
                break
        return {"said": said, "before": before, "after": mode}


class Franky:
    """The motions that researchers write with franky, which asks for version 10.

    Args:
        host: Address of the arm and of its hand.
    """

    def __init__(self, host):
        import franky

        self._f, self._host = franky, host
        ignore = franky.RealtimeConfig.Ignore
        self._robot = franky.Robot(host, realtime_config=ignore)
        self._robot.relative_dynamics_factor = 0.2

    def run(self):
        """Return what each scenario saw."""
        f, robot = self._f, self._robot
        begin = list(robot.state.q)
        robot.move(f.JointMotion(ASIDE))
        seen = {"joint": {"end": list(robot.state.q)}}
        up = f.CartesianMotion(f.Affine([0.0, 0.0, 0.05]), f.ReferenceType.Relative)
        before = list(robot.state.q)
        robot.move(up)
        seen["cartesian"] = {"begin": before, "end": list(robot.state.q)}
        ways = [[0.0, -0.5, 0.0, -2.1, 0.0, 1.7, 0.7], begin]
        robot.move(
            f.JointWaypointMotion([f.JointWaypoint(f.JointState(one)) for one in ways])
        )
        seen["waypoints"] = {"begin": begin, "end": list(robot.state.q)}
        down = f.CartesianMotion(f.Affine([0.0, 0.0, 0.2]), f.ReferenceType.Relative)
        stop = f.CartesianStopMotion()
        down.add_reaction(f.Reaction(f.Measure.REL_TIME > 0.3, stop))
        robot.move(down)
        seen["reaction"] = {"begin": begin, "end": list(robot.state.q)}
        before = list(robot.state.q)
        left = f.CartesianWaypoint(f.Affine([0.0, 0.05, 0.0]), f.ReferenceType.Relative)
        up = f.CartesianWaypoint(f.Affine([0.0, 0.0, -0.04]), f.ReferenceType.Relative)
        robot.move(f.CartesianWaypointMotion([left, up]))
        seen["cartesian waypoints"] = {"begin": before, "end": list(robot.state.q)}
        seen |= self._torques()
        hand = f.Gripper(self._host)
        seen["hand"] = {"moved": hand.move(0.04, 0.05), "width": hand.width}
        return seen

    def _torques(self):
        """Return where springs and torques that franky computes lead the arm."""
        f, robot = self._f, self._robot
        begin = np.array(robot.state.q)
        goal = begin + np.array(TURN)
        stiff = [600.0] * 4 + [250.0, 150.0, 50.0]
        torques = f.SimpleTorqueMotion(signal_timeout=1.0)
        seen = {}
        for name, motion in (
            ("joint impedance", f.JointImpedanceMotion(goal, stiffness=stiff)),
            ("torques", torques),
            (
                "cartesian impedance",
                f.CartesianImpedanceMotion(
                    f.Affine([0.0, 0.0, -0.03]),
                    target_type=f.ReferenceType.Relative,
                    translational_stiffness=1500.0,
                    rotational_stiffness=80.0,
                ),
            ),
        ):
            before = list(robot.state.q)
            robot.move(motion, asynchronous=True)
            deadline = time.monotonic() + 1.5
            while time.monotonic() < deadline:
                if motion is torques:
                    off, dq = begin - robot.state.q, np.array(robot.state.dq)
                    torques.set_torque(np.array(stiff) / 3.0 * (off - 0.1 * dq))
                time.sleep(0.002)
            seen[name] = {"begin": before, "end": list(robot.state.q)}
            robot.move(f.TorqueStopMotion())
        return seen


def main(host, client):
    """Run every scenario of a client."""
    programs = {"pylibfranka": Pylibfranka, "franky": Franky}
    sys.stdout.write(json.dumps(programs[client](host).run()))


if __name__ == "__main__":
    main(*sys.argv[1:])
