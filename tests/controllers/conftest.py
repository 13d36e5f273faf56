"""A small robot without physics worth speaking of, and a way to load controllers."""

import pytest

from station.core.hardware.interfaces import (
    EffortJointInterface,
    JointHandle,
    JointStateHandle,
    JointStateInterface,
    PositionJointInterface,
    VelocityJointInterface,
)
from station.core.hardware.robot_hw import RobotHW
from station.core.parameters import Parameters, ParameterTree

URDF = """
<robot name="fake">
  <joint name="slide" type="prismatic">
    <limit lower="-0.5" upper="0.5" velocity="1" effort="50"/>
  </joint>
  <joint name="elbow" type="revolute">
    <limit lower="-2.0" upper="3.0" velocity="2" effort="80"/>
  </joint>
  <joint name="wheel" type="continuous"/>
</robot>
"""
JOINTS = ["slide", "elbow", "wheel"]


class FakeRobotHW(RobotHW):
    """Unit masses driven by efforts, or ideal joints driven by velocity or position."""

    def __init__(self, joints=JOINTS, urdf=URDF):
        super().__init__()
        size = len(joints)
        self.position = [0.0] * size
        self.velocity = [0.0] * size
        self.effort = [0.0] * size
        self.commands = {}
        states = JointStateInterface()
        self.register_interface(states)
        for kind in (
            PositionJointInterface,
            VelocityJointInterface,
            EffortJointInterface,
        ):
            interface = kind()
            self.commands[kind] = [0.0] * size
            for index, name in enumerate(joints):
                state = JointStateHandle(
                    name, self.position, self.velocity, self.effort, index
                )
                states.register_handle(state)
                interface.register_handle(JointHandle(state, self.commands[kind]))
            self.register_interface(interface)
        self.tree = ParameterTree({"robot_description": urdf} if urdf else {})
        self.time = 100.0

    @property
    def efforts_commanded(self):
        """Efforts commanded last [Nm or N], in the order of the robot's joints."""
        return self.commands[EffortJointInterface]

    @property
    def positions_commanded(self):
        """Positions commanded last [rad or m]."""
        return self.commands[PositionJointInterface]

    @property
    def velocities_commanded(self):
        """Velocities commanded last [rad/s or m/s]."""
        return self.commands[VelocityJointInterface]

    def load(self, controller_class, name="arm", **values):
        """Return an initialised controller with the parameters `values`."""
        params = Parameters(self.tree, name)
        params.set("", values)
        controller = controller_class()
        controller.claims = controller.init_request(self, params)
        return controller

    def start(self, controller_class, **values):
        """Return a running controller with the parameters `values`."""
        controller = self.load(controller_class, **values)
        controller.start_request(self.time)
        return controller

    def step(self, controller, count=1, period=0.001):
        """Run `count` cycles of a controller without moving any joint."""
        for _ in range(count):
            self.time += period
            controller.update_request(self.time, period)

    def run_with_position(self, controller, count=1, period=0.001, stuck=()):
        """Run `count` cycles; joints that are not `stuck` follow position commands."""
        for _ in range(count):
            self.step(controller, period=period)
            for index, command in enumerate(self.positions_commanded):
                if index not in stuck:
                    self.velocity[index] = (command - self.position[index]) / period
                    self.position[index] = command

    def run_with_effort(self, controller, count, period=0.001):
        """Run `count` cycles with unit masses under the commanded efforts."""
        for _ in range(count):
            self.step(controller, period=period)
            for index, effort in enumerate(self.efforts_commanded):
                self.velocity[index] += effort * period
                self.position[index] += self.velocity[index] * period


@pytest.fixture
def robot():
    return FakeRobotHW()


@pytest.fixture
def make_robot():
    return FakeRobotHW


def send(controller, values):
    """Post a set-point as the facade does: checked first."""
    controller.set_points.check(values)
    controller.set_points.post(values)


@pytest.fixture(name="send")
def send_fixture():
    return send
