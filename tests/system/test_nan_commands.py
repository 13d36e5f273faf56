"""A command that is no number ends its controller, and nothing else."""

from math import nan

import pytest
from typing_extensions import override

from station.core.control.controller import Controller, ControllerState
from station.core.control.controller_loader import TableLoader
from station.core.control.switching import SwitchRequest
from station.core.franka import (
    FrankaPoseCartesianInterface,
    FrankaVelocityCartesianInterface,
)
from station.core.franka.arms import Arms
from station.core.hardware.interfaces import (
    EffortJointInterface,
    PositionJointInterface,
    VelocityJointInterface,
)
from tests.franka_station import JOINTS, make_franka_station

BAD_AFTER = 200


class JointBreaker(Controller):
    """Commands zeros or the present position, and after a while no number."""

    @override
    def init(self, hw, params):
        self.handles = [hw.get_handle(name) for name in JOINTS]
        self.count = 0

    @override
    def starting(self, time):
        self.count = 0

    @override
    def update(self, time, period):
        self.count += 1
        if self.count == BAD_AFTER:
            self.handles[3].set_command(nan)


class EffortBreaker(JointBreaker):
    """Commands torques."""

    hardware_interface = EffortJointInterface


class PositionBreaker(JointBreaker):
    """Commands positions."""

    hardware_interface = PositionJointInterface


class VelocityBreaker(JointBreaker):
    """Commands velocities."""

    hardware_interface = VelocityJointInterface


class PoseBreaker(Controller):
    """Commands the present pose, and after a while no number."""

    hardware_interface = FrankaPoseCartesianInterface

    @override
    def init(self, hw, params):
        self.handle = hw.get_handle("panda_robot")

    @override
    def starting(self, time):
        self.count = 0
        self.handle.set_command(list(self.handle.get_robot_state().O_T_EE_d))

    @override
    def update(self, time, period):
        self.count += 1
        if self.count == BAD_AFTER:
            self.handle.set_command([nan] * 16)


class TwistBreaker(PoseBreaker):
    """Commands rest, and after a while no number."""

    hardware_interface = FrankaVelocityCartesianInterface

    @override
    def starting(self, time):
        self.count = 0
        self.handle.set_command([0.0] * 6)

    @override
    def update(self, time, period):
        self.count += 1
        if self.count == BAD_AFTER:
            self.handle.set_command([0.0] * 5 + [nan])


class ElbowBreaker(TwistBreaker):
    """Commands an elbow that is no number after a while."""

    @override
    def update(self, time, period):
        self.count += 1
        if self.count == BAD_AFTER:
            self.handle.set_command([0.0] * 6, [nan, -1.0])


@pytest.mark.parametrize(
    "name",
    [
        "EffortBreaker",
        "PositionBreaker",
        "VelocityBreaker",
        "PoseBreaker",
        "TwistBreaker",
        "ElbowBreaker",
    ],
)
def test_command_that_is_no_number_ends_its_controller(name):
    station = make_franka_station()
    table = {f"test/{name}": f"{__name__}:{name}"}
    station.loop.manager.register_loader(TableLoader(table))
    station.load_controller("bad", f"test/{name}", {})
    station.switch_controllers(SwitchRequest(("bad",), ()))
    station.loop.step(BAD_AFTER - 10)
    assert station.latest().mode == "move"
    before = Arms(station.robots).state("panda").q
    station.loop.step(500)

    status = station.controller("bad")

    # An elbow is looked at by the robot, the rest by the manager already.
    if name == "ElbowBreaker":
        assert status.state is ControllerState.STOPPED
        assert "a command is not finite" in status.fault
    else:
        assert status.state is ControllerState.ABORTED
        assert "nan" in status.fault
    assert station.latest().mode == "idle"
    assert Arms(station.robots).report("panda").errors == ()
    assert Arms(station.robots).state("panda").q == pytest.approx(before, abs=1e-3)
    station.switch_controllers(SwitchRequest(("arm",), ()))
    station.loop.step(10)
    assert station.latest().mode == "move"
