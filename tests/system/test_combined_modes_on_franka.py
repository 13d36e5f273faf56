"""Torques of one controller around the motion that another one generates."""

from itertools import permutations

import numpy as np
import pytest

from station.controllers import CONTROLLERS
from station.core.clock import ManualClock
from station.core.control.controller import MultiInterfaceController
from station.core.control.controller_loader import TableLoader
from station.core.control.controller_manager import ControllerManager
from station.core.control.switching import SwitchRequest
from station.core.facade.station import Station
from station.core.franka import FrankaStateInterface
from station.core.franka.arms import Arms
from station.core.hardware.interfaces import EffortJointInterface, JointGroup
from station.core.loop.control_loop import ControlLoop
from station.core.parameters import Parameters, ParameterTree
from station.hw.franka.arm.control_mode import ControlMode
from station.hw.franka.franka_hw import FrankaHW

pytestmark = pytest.mark.long

JOINTS = [f"panda_joint{number}" for number in range(1, 8)]
K = np.array([600.0, 600.0, 600.0, 600.0, 250.0, 150.0, 50.0])
D = np.array([50.0, 50.0, 50.0, 20.0, 20.0, 20.0, 10.0])
GENERATORS = {
    "JointPosition": ControlMode.JOINT_POSITION,
    "JointVelocity": ControlMode.JOINT_VELOCITY,
    "CartesianVelocity": ControlMode.CARTESIAN_VELOCITY,
    "CartesianPose": ControlMode.CARTESIAN_POSE,
    "Elbow": ControlMode.CARTESIAN_POSE,
}
SECONDS = 2.0


class Impedance(MultiInterfaceController):
    """Follows q_d by torques, whoever makes it."""

    required_interfaces = (EffortJointInterface, FrankaStateInterface)

    def init(self, hw, params):
        efforts = hw.get(EffortJointInterface)
        self.joints = JointGroup([efforts.get_handle(name) for name in JOINTS])
        self.arm = hw.get(FrankaStateInterface).get_handle("panda_robot")

    def update(self, time, period):
        state = self.arm.get_robot_state()
        tau = K * np.subtract(state.q_d, state.q) + D * np.subtract(
            state.dq_d, state.dq
        )
        self.joints.set_commands(tau.tolist())


class ZeroTorque(Impedance):
    """Lets the arm float."""

    def update(self, time, period):
        self.joints.set_commands([0.0] * 7)


def make_station() -> Station:
    robot = {
        "arm_id": "panda",
        "robot_description": "example-robot-data:panda",
        "realism": "ideal",
    }
    tree = ParameterTree({"robot": robot})
    hw = FrankaHW()
    hw.init(Parameters(tree), Parameters(tree, "robot"))
    clock, own = ManualClock(), {"test/Impedance": Impedance, "test/Zero": ZeroTorque}
    loaders = [TableLoader(CONTROLLERS), TableLoader(own)]
    manager = ControllerManager(hw, Parameters(tree), loaders, clock)
    station = Station(ControlLoop(hw, manager, clock=clock), manager, Parameters(tree))
    for name, kind in (("impedance", "Impedance"), ("zero", "Zero")):
        station.load_controller(name, f"test/{kind}", {})
    for kind in GENERATORS:
        station.load_controller(
            kind,
            f"franka_example_controllers/{kind}ExampleController",
            {"arm_id": "panda", "joint_names": JOINTS},
        )
    station.loop.step()
    return station


def desired_at_the_end(kind: str, *torques: str) -> tuple[Station, list[float]]:
    """Run a motion for a while; return the station and q_d at the end."""
    station = make_station()
    assert station.switch_controllers(SwitchRequest((kind, *torques), ())).ok
    station.loop.step(round(SECONDS * 1000))
    assert station.latest().mode == "move", station.controller(kind).fault
    return station, Arms(station.robots).state("panda").q_d


@pytest.mark.parametrize("kind", GENERATORS)
def test_arm_follows_the_motion_by_torques(kind: str) -> None:
    station, desired = desired_at_the_end(kind, "impedance")

    assert station.loop.hw.control_mode == GENERATORS[kind] | ControlMode.JOINT_TORQUE
    state = Arms(station.robots).state("panda")
    start = station.loop.hw.parameters.initial_positions
    assert np.abs(np.subtract(desired, start)).max() > 0.02
    assert state.q == pytest.approx(desired, abs=3e-3)
    assert not any(state.current_errors)
    assert state.tau_J_d == pytest.approx(station.loop.hw.commands.efforts, abs=0.05)


@pytest.mark.parametrize("kind", GENERATORS)
def test_motion_is_that_without_torques_and_torques_alone_move_the_arm(
    kind: str,
) -> None:
    _, alone = desired_at_the_end(kind)
    station, desired = desired_at_the_end(kind, "zero")

    # Torques begin to act a cycle later, and the motion with them.
    assert desired == pytest.approx(alone, abs=5e-4)
    start = station.loop.hw.parameters.initial_positions
    assert Arms(station.robots).state("panda").q == pytest.approx(start, abs=2e-3)


def test_torques_go_on_while_the_motion_changes() -> None:
    station = make_station()
    station.switch_controllers(SwitchRequest(("impedance",), ()))
    running: tuple[str, ...] = ()
    for kind in GENERATORS:
        result = station.switch_controllers(SwitchRequest((kind,), running))
        assert result.ok
        running = (kind,)
        station.loop.step(400)
        assert station.latest().mode == "move", station.controller(kind).fault
        assert "impedance" in {c.name for c in station.controllers() if is_running(c)}
    assert not any(Arms(station.robots).state("panda").last_motion_errors)


@pytest.mark.parametrize("torques", [(), ("impedance",)])
@pytest.mark.parametrize(("first", "second"), list(permutations(GENERATORS, 2)))
def test_motion_is_taken_over_in_motion_without_an_error(
    first: str, second: str, torques: tuple[str, ...]
) -> None:
    station = make_station()
    station.switch_controllers(SwitchRequest((first, *torques), ()))
    station.loop.step(700)

    result = station.switch_controllers(SwitchRequest((second,), (first,)))
    station.loop.step(400)

    assert max(result.jump.values()) < 1e-3
    assert station.latest().mode == "move", station.controller(second).fault
    running = {c.name for c in station.controllers() if is_running(c)}
    assert running == {second, *torques}


def is_running(status) -> bool:
    return status.state.value == "running"
