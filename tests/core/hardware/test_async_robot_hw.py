"""Asynchronous hardware: the cycle never waits, and stepped cycles are the same."""

import threading
from itertools import pairwise

import pytest
from typing_extensions import override

from station.core.control.controller import ControllerState
from station.core.errors import HardwareInterfaceError, SwitchRefusedError
from station.core.hardware.async_robot_hw import AsyncRobotHW
from station.core.hardware.combined_robot_hw import CombinedRobotHW
from station.core.hardware.interfaces import JointStateInterface
from station.core.hardware.robot_hw import SwitchState
from station.core.parameters import Parameters
from station.hw.mock import MockRobotHW
from station.hw.mujoco.mujoco_robot_hw import MujocoRobotHW
from station.testing import Bench
from tests.waiting import PATIENCE

ROBOT = """
<robot name="r"><link name="base"/><link name="column"><inertial><mass value="1"/>
  <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="j" type="continuous"><parent link="base"/><child link="column"/>
  <axis xyz="0 0 1"/></joint></robot>
"""
GROUP = "velocity_controllers/JointGroupVelocityController"


class Device(MockRobotHW):
    """A real robot, held up by its test; notes what is called, and where."""

    def __init__(self):
        super().__init__()
        self.begun, self.go = threading.Semaphore(0), threading.Semaphore(0)
        self.is_held = False
        self.calls = []
        self.error = None

    @override
    def simulated_world(self):
        return None

    @override
    def write(self, time, period):
        self.begun.release()
        if self.is_held:
            assert self.go.acquire(timeout=PATIENCE)
        self.calls.append((round(time, 6), round(period, 6)))
        super().write(time, period)

    @override
    def read(self, time, period):
        if self.error is not None:
            raise self.error
        super().read(time, period)

    @override
    def do_switch(self, start, stop):
        assert not self.is_busy()
        super().do_switch(start, stop)


def make(*, cycles=1, time_limit=1.0, device=None, policy="synchronized"):
    """Return a bench of an asynchronous robot of one joint, and the robot."""
    device = Device() if device is None else device
    parameters = {
        "joints": ["j1"],
        "is_async": True,
        "async_parameters": {
            "cycles": cycles,
            "time_limit": time_limit,
            "scheduling_policy": policy,
        },
    }
    hw = wrap(device, parameters)
    device.is_busy = lambda: not hw.calls.is_idle()
    bench = Bench(hw, parameters, period=0.001)
    bench.load_controller("group", GROUP, joints=["j1"])
    return bench, hw, device


def wrap(robot, parameters):
    tree = Parameters()
    tree.set("hw", parameters)
    return AsyncRobotHW.wrap(robot, tree.namespace("hw"))


def live(bench, device):
    """Let threads carry the calls out, as with a loop that runs."""
    bench.switch(start=["group"])
    bench.manager.pump = None
    device.is_held = True


def let_it_end(hw, device):
    """Let the call under way end; its end is waited for without sleeping."""
    device.go.release()
    for _ in range(10_000_000):
        if hw.calls.is_idle():
            return
    raise AssertionError("the call does not end")


def statistics(bench):
    (component,) = bench.manager.hardware_components()
    return component.async_update


def run(bench, cycles=20):
    """Return the commands and the positions of each cycle, the velocity being 0.5."""
    bench.switch(start=["group"])
    bench.manager.get_controller("group").set_points.post([0.5])
    found = []
    for _ in range(cycles):
        bench.step()
        joint = bench.robot.get(JointStateInterface).handles()[0]
        found.append((bench.commands(), joint.get_position()))
    return found


@pytest.mark.parametrize("cycles", [1, 3])
def test_a_stepped_robot_is_charged_the_declared_cycles(cycles):
    bench, _, device = make(cycles=cycles)
    twin, _, _ = make(cycles=cycles)

    first, second = run(bench), run(twin)

    assert first == second
    positions = [position for _, position in first]
    # It moves when the first state after a call counts, and every n-th cycle then.
    changes = [n for n in range(1, 20) if positions[n] != positions[n - 1]]
    assert {b - a for a, b in pairwise(changes)} == {cycles}
    assert statistics(bench).age == cycles + (20 - changes[-1] - 1)
    assert device.calls[5][1] == 0.001 * cycles


def test_a_simulated_robot_stays_in_the_cycle_beside_a_loop_that_runs():
    class Simulated(Device):
        simulated_world = MockRobotHW.simulated_world

    bench, hw, _ = make(device=Simulated())
    bench.manager.pump = None

    bench.step(3)

    assert hw.calls.is_idle()
    assert statistics(bench).missed == 0


def test_a_cycle_does_not_wait_for_the_robot_and_tells_the_age_of_its_states():
    bench, hw, device = make()
    live(bench, device)

    bench.step(4)

    assert device.begun.acquire(timeout=PATIENCE)
    assert statistics(bench).missed == 3
    device.joints.position[0] = 0.25
    device.is_held = False
    let_it_end(hw, device)
    joint = hw.get(JointStateInterface).handles()[0]
    assert joint.get_position() != device.joints.position[0]
    bench.step()
    assert joint.get_position() == pytest.approx(0.25, abs=1e-3)
    assert statistics(bench).age == 4
    bench.manager.end_async_threads()


def test_a_switch_of_the_robot_waits_for_the_call_and_the_cycle_does_not():
    bench, hw, device = make()
    live(bench, device)
    bench.step()
    assert device.begun.acquire(timeout=PATIENCE)
    before = list(device.switches)

    bench.manager.stop_all(bench.time)
    assert hw.switch_result() is SwitchState.ONGOING
    assert device.switches == before
    device.is_held = False
    let_it_end(hw, device)
    bench.step()

    assert device.switches == [*before, ((), ("group",))]
    bench.manager.end_async_threads()


def test_a_switch_that_fails_late_is_an_error_of_its_result():
    bench, hw, device = make()
    live(bench, device)
    bench.step()
    assert device.begun.acquire(timeout=PATIENCE)

    def fail(*_):
        raise OSError("no answer")

    hw._hw.do_switch = fail
    hw.do_switch([], [])
    device.is_held = False
    let_it_end(hw, device)
    bench.step()

    assert hw.switch_result() is SwitchState.ERROR
    bench.manager.end_async_threads()


def test_a_robot_that_does_not_answer_loses_its_controllers():
    bench, hw, device = make(time_limit=0.002)
    live(bench, device)

    bench.step(6)

    status = bench.status("group")
    assert status.state is ControllerState.STOPPED
    assert "has not answered for 0.002 s" in status.fault
    with pytest.raises(SwitchRefusedError, match="'hw' has not answered"):
        hw.prepare_switch([bench.manager.lifecycle.find("group").info], [])
    device.is_held = False
    let_it_end(hw, device)
    bench.step()
    assert not hw.is_interrupted()
    bench.manager.end_async_threads()


def test_what_a_read_raises_ends_the_cycle_as_without_a_thread():
    bench, _, device = make()
    bench.step()
    device.error = OSError("the line is dead")
    bench.step()

    with pytest.raises(OSError, match="the line is dead"):
        bench.step()


def test_one_robot_of_several_is_asynchronous():
    device = Device()
    device.is_busy = lambda: False
    robots = {"fast": MockRobotHW(), "slow": device}
    combined = CombinedRobotHW(robots.__getitem__)
    parameters = {
        "robot_hardware": ["fast", "slow"],
        "fast": {"type": "fast", "joints": ["f1"]},
        "slow": {"type": "slow", "joints": ["s1"], "is_async": True},
    }
    bench = Bench(combined, parameters, period=0.001)
    bench.load_controller("both", GROUP, joints=["f1", "s1"])
    bench.switch(start=["both"])

    bench.step(3)

    fast, slow = bench.manager.hardware_components()
    assert fast.async_update is None
    assert slow.async_update.age == 1
    assert {one.resource for one in slow.command_interfaces} == {"s1"}


def test_a_simulated_robot_of_a_description_can_be_asynchronous(tmp_path):
    path = tmp_path / "r.urdf"
    path.write_text(ROBOT)
    parameters = {"robot_description": str(path), "is_async": True}
    bench = Bench(wrap(MujocoRobotHW(), parameters), parameters)

    bench.step(5)

    assert statistics(bench).age == 1


def test_a_robot_whose_handles_cannot_be_copied_is_refused():
    class Odd:
        """An interface that is no set of handles."""

    class Reader(Device):
        @override
        def init(self, root_params, hw_params):
            super().init(root_params, hw_params)
            self.register_interface(Odd())

    with pytest.raises(HardwareInterfaceError, match="'hw' cannot be asynchronous"):
        make(device=Reader())
