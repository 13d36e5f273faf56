"""An arm without inertia that checks what it is commanded as a Franka does."""

from itertools import pairwise
from math import sqrt

import pytest

from station.core.clock import ManualClock
from station.core.franka import (
    Frame,
    FrankaCartesianPoseHandle,
    FrankaModelHandle,
    FrankaModelInterface,
    FrankaPoseCartesianInterface,
)
from station.core.franka.franka_robot_state import RobotState
from station.core.franka.model_sources import ModelSource
from station.core.hardware.robot_hw import RobotHW
from station.core.parameters import Parameters, ParameterTree
from station.hw.franka.arm.franka_kinematics import (
    frame_pose,
    zero_jacobian,
)
from station.hw.franka.arm.self_collision import clearance
from station.memory.doubles import put, zeros
from tests.conformance.benches import JOINTS, POSE, panda
from tests.hw.franka.cartesian_motions import PERIOD, Generator
from tests.hw.franka.plain_model import PlainModel

PARAMETERS = {"arm_id": "panda", "joint_names": JOINTS}


class Kinematics:
    """The part of an arm's model that moves need."""

    pose = staticmethod(frame_pose)
    zero_jacobian = staticmethod(zero_jacobian)
    body_jacobian = PlainModel().body_jacobian

    @staticmethod
    def pose_source(*arguments):
        return ModelSource(lambda result: put(result, frame_pose(*arguments)))

    @staticmethod
    def zero_jacobian_source(*arguments):
        return ModelSource(lambda result: put(result, zero_jacobian(*arguments)))

    @staticmethod
    def clearance(q):
        return clearance(q, has_hand=True)


class IdealArm(RobotHW):
    """Goes where it is commanded at once; keeps every error a Franka would raise."""

    def __init__(self, q=POSE):
        super().__init__()
        self.state = RobotState()
        self.command = zeros(16)
        poses, models = FrankaPoseCartesianInterface(), FrankaModelInterface()
        poses.register_handle(
            FrankaCartesianPoseHandle(
                "panda_robot", self.state, lambda: None, self.command, zeros(2)
            )
        )
        models.register_handle(
            FrankaModelHandle("panda_model", Kinematics(), self.state)
        )
        self.register_interface(poses)
        self.register_interface(models)
        self.tree = ParameterTree({"robot_description": panda().xml})
        self.motion = Generator(self.state)
        self.clock = ManualClock()
        self.time = 0.0
        self.errors = []
        self.twists = []
        self._go_to(list(q))
        self.motion.begin()

    def load(self, controller_class, **values):
        """Return an initialised controller with the parameters `values`."""
        params = Parameters(self.tree, "it")
        params.set("", {**PARAMETERS, **values})
        controller = controller_class()
        controller.init_request(self, params)
        controller.set_points.clock = self.clock
        return controller

    def start(self, controller_class, **values):
        """Return a running controller with the parameters `values`."""
        controller = self.load(controller_class, **values)
        controller.start_request(self.time)
        return controller

    def run(self, controller, cycles, period=PERIOD):
        """Run cycles; the wall clock goes on with the arm's time."""
        for _ in range(cycles):
            self.time += period
            self.clock.advance(period)
            controller.update_request(self.time, period)
            self._follow()

    def rates(self, order):
        """Return the largest translation and rotation of a derivative of the pose.

        Args:
            order: 1 for velocities, 2 for accelerations, 3 for jerks.
        """
        rows = self.twists
        for _ in range(order - 1):
            rows = [
                [(b - a) / PERIOD for a, b in zip(before, after, strict=True)]
                for before, after in pairwise(rows)
            ]
        return (
            max(length(row[:3]) for row in rows),
            max(length(row[3:]) for row in rows),
        )

    def _follow(self):
        self.errors += self.motion.receive(self.command)
        q, errors = self.motion.solve()
        self.errors += errors
        self.twists.append(list(self.state.O_dP_EE_c))
        last = self.state.dq_d[:]
        self.state.dq_d = [
            (new - old) / PERIOD for new, old in zip(q, self.state.q_d, strict=True)
        ]
        self.state.ddq_d = [
            (new - old) / PERIOD for new, old in zip(self.state.dq_d, last, strict=True)
        ]
        self._go_to(q)

    def _go_to(self, q):
        state = self.state
        state.q, state.q_d, state.dq = q, q, state.dq_d
        pose = frame_pose(Frame.END_EFFECTOR, q, state.F_T_EE)
        state.O_T_EE, state.O_T_EE_d = pose, pose


def length(vector):
    """Return the Euclidean norm."""
    return sqrt(sum(value * value for value in vector))


@pytest.fixture
def arm():
    """Return an arm in the middle of its workspace."""
    return IdealArm()


@pytest.fixture
def make_arm():
    """Return the class of the arms, for other poses."""
    return IdealArm
