"""A robot of one joint, and the controller `test/Spring` for it."""

from station.core.clock import ManualClock
from station.core.control.controller import Controller, ControllerSample
from station.core.control.controller_loader import ClassLoader, TableLoader
from station.core.control.controller_manager import ControllerManager
from station.core.control.tunables import Tunable, Tunables
from station.core.declared_parameter import DeclaredParameter, ParameterType
from station.core.facade.station import Station
from station.core.hardware.interfaces import (
    EffortJointInterface,
    JointHandle,
    JointStateHandle,
    JointStateInterface,
)
from station.core.hardware.robot_hw import RobotHW
from station.core.loop.control_loop import ControlLoop
from station.core.parameters import Parameters
from station.core.ports.set_point import SetPointElement, SetPointPort


class Spring(Controller[EffortJointInterface]):
    """Pulls one joint to a set-point with a stiffness that can be tuned."""

    hardware_interface = EffortJointInterface

    def init(self, interface, params):
        """Claim the joint."""
        self.joint = interface.get_handle(params.get_str("joint"))
        self.tunables = Tunables(
            {"k": Tunable("Nm/rad", 0.0, 10.0)}, {"k": params.get_float("k", 1.0)}
        )
        self.target = 0.0
        self.joint_names = ["j"]
        self.set_points = SetPointPort([SetPointElement("j", "rad", -1.0, 1.0)])

    def starting(self, time):
        """Begin where the joint is."""
        self.target = self.joint.get_position()

    def update(self, time, period):
        """Pull."""
        command = self.set_points.take()
        if command is not None:
            self.target = command[0]
        position = self.joint.get_position()
        effort = self.tunables.values["k"] * (self.target - position)
        self.joint.set_command(effort)
        self.sample = ControllerSample(
            time, [self.target], [position], [self.target - position], [effort]
        )


class PickySpring(Spring):
    """Declares what it reads, so that nothing else is taken."""

    @classmethod
    def declared_parameters(cls):
        """Return the joint and the stiffness."""
        return (
            DeclaredParameter(
                name="joint", type=ParameterType.STRING, description="the joint"
            ),
            DeclaredParameter(
                name="k", type=ParameterType.NUMBER, default=1.0, description="pull"
            ),
        )


class OneJointHW(RobotHW):
    """One joint that never moves, under effort control."""

    def __init__(self):
        super().__init__()
        state = JointStateHandle("j", [0.25], [0.0], [0.0])
        states, efforts = JointStateInterface(), EffortJointInterface()
        states.register_handle(state)
        efforts.register_handle(JointHandle(state, [0.0]))
        self.register_interface(states)
        self.register_interface(efforts)
        self.present_mode = super().mode()

    def mode(self):
        """Return the mode that a test has set."""
        return self.present_mode


def make_station(clock=None):
    """Return a station over one joint; its loop is not started."""
    hw, clock, parameters = OneJointHW(), clock or ManualClock(), Parameters()
    table = TableLoader({"test/Spring": "tests.api.spring:Spring"})
    loaders = [table, ClassLoader(["tests.api.spring"])]
    manager = ControllerManager(hw, parameters, loaders, clock)
    # A busy machine may hold an update up for long; no test here is about that.
    loop = ControlLoop(hw, manager, clock=clock, update_budget=60.0)
    return Station(loop, manager, parameters, "test/OneJointHW")
