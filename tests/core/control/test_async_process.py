"""Updates in a process of its own: the same results, and what happens at its end."""

import os
import signal
import threading

import pytest
from typing_extensions import override

from station.core.control import async_process
from station.core.control.controller import Controller, ControllerSample
from station.core.control.tunables import Tunable, Tunables
from station.core.errors import ControllerLoadError, ParameterError
from station.core.hardware.async_robot_hw import AsyncRobotHW
from station.core.hardware.interfaces import EffortJointInterface
from station.core.parameters import Parameters, ParameterTree
from station.core.ports.set_point import SetPointElement, SetPointPort
from station.hw.mock import MockRobotHW
from station.testing.bench import Bench
from tests.waiting import wait_until

STATION = os.getpid()
RAISES, HANGS = 8.0, 9.0


class Elsewhere(Controller[EffortJointInterface]):
    """Commands gain times position, plus its set-point."""

    hardware_interface = EffortJointInterface

    @override
    def init(self, interface, params):
        if params.get_float("broken", 0.0) not in {0.0, os.getpid()}:
            raise RuntimeError("no such device")
        self.joint = interface.get_handle("j1")
        self.set_points = SetPointPort([SetPointElement("offset", "", -9.0, 9.0)])
        self.tunables = Tunables(
            {"gain": Tunable("", 0.0, 9.0, "Of the position.")}, {"gain": 1.0}
        )
        self.offset = 0.0

    @override
    def starting(self, time):
        self.offset = 0.0

    @override
    def update(self, time, period):
        if self.set_points.take_void():
            self.offset = 0.0
        newest = self.set_points.take()
        if newest is not None:
            (self.offset,) = newest
        if self.offset == RAISES:
            raise ValueError("no solution")
        while self.offset == HANGS:
            pass
        gain = self.tunables.values["gain"]
        output = gain * self.joint.get_position() + self.offset
        self.joint.set_command(output)
        self.sample = ControllerSample(time, [gain], [period], [os.getpid()], [output])
        self.messages = {"state": {"process": os.getpid()}}


def make(kind=Elsewhere, **parameters):
    bench = Bench(robot_parameters={"joints": ["j1"]}, period=0.001)
    options = {"process": True, **parameters.pop("async_parameters", {})}
    bench.load_controller(
        "it", kind, is_async=True, async_parameters=options, **parameters
    )
    return bench, bench.manager.get_controller("it"), bench.robot.joints


def command(bench):
    (guard,) = bench.manager.lifecycle.find("it").commands.guards
    storage, index = guard.slots[0]
    return storage[index]


@pytest.fixture(scope="module")
def running():
    bench, it, joints = make()
    yield bench, it, joints
    bench.switch(stop=["it"])
    bench.manager.unload_controller("it")


def wait_until_idle(bench):
    beside = bench.manager.lifecycle.find("it").beside
    assert wait_until(beside.is_idle, pause=0.0)


def step(bench, joints, cycles=2):
    """Run cycles with the joint at 0.25, and return the commands after each."""
    found = []
    for _ in range(cycles):
        # The effort moves the mock by micrometres in a cycle.
        joints.position[0], joints.velocity[0] = 0.25, 0.0
        bench.step()
        found.append(round(command(bench), 4))
    return found


def restart(bench):
    bench.switch(stop=["it"])
    bench.switch(start=["it"])
    # A stepped station has waited for the stop, so that every run is the same.
    assert bench.state("it") == "running"


def test_a_stepped_station_has_its_results_after_the_declared_cycles(running):
    bench, it, joints = running
    bench.switch(start=["it"])
    # At rest until the first update has ended, which counts a cycle later.
    assert step(bench, joints, 3) == [0.0, 0.25, 0.25]
    process = it.published()["state"]["process"]
    assert process != STATION
    assert it.sample.error == [process]
    assert bench.status("it").async_update.age == 1

    it.tunables.apply(it.tunables.checked({"gain": 2.0}))
    it.set_points.post([0.5])
    assert step(bench, joints) == [0.25, 1.0]
    assert it.sample.desired == [2.0]

    # A new start forgets the set-point; the gains stay, and so does the process.
    restart(bench)
    assert step(bench, joints) == [0.0, 0.5]
    assert it.published()["state"]["process"] == process


def test_a_thread_asks_it_and_no_cycle_waits(running):
    bench, _, joints = running
    restart(bench)
    pump, bench.manager.pump = bench.manager.pump, None
    assert step(bench, joints, 1) == [0.0]
    wait_until_idle(bench)
    (found,) = step(bench, joints, 1)
    assert found == 0.25 * bench.manager.get_controller("it").tunables.values["gain"]
    wait_until_idle(bench)
    # Its thread asks for the end, too: the control thread starts none.
    before = set(threading.enumerate())
    bench.manager.lifecycle.find("it").beside.stopping(bench.time)
    assert set(threading.enumerate()) <= before
    wait_until_idle(bench)
    bench.manager.end_async_threads()
    bench.manager.pump = pump


def test_a_copy_of_the_station_leaves_its_process_alone(running, monkeypatch):
    bench, it, joints = running
    restart(bench)
    step(bench, joints)
    process = it.published()["state"]["process"]
    with monkeypatch.context() as context:
        context.setattr(async_process.os, "getpid", lambda: -1)
        step(bench, joints)
        assert "a copy of the station" in bench.status("it").fault
    bench.switch(start=["it"])
    assert step(bench, joints)[1] > 0.0
    assert it.published()["state"]["process"] == process


def test_a_killed_process_is_told_with_its_end_and_replaced(running):
    bench, it, joints = running
    restart(bench)
    step(bench, joints)
    killed = it.published()["state"]["process"]
    os.kill(killed, signal.SIGKILL)
    step(bench, joints)
    fault = bench.status("it").fault
    assert f"the process of its updates (Elsewhere, {killed}) has ended" in fault
    assert "exit code -9" in fault
    bench.switch(start=["it"])
    assert step(bench, joints)[1] > 0.0
    assert it.published()["state"]["process"] != killed


def test_a_process_that_hangs_is_a_fault_and_what_is_raised_is_another(monkeypatch):
    monkeypatch.setattr(async_process, "_GRACE", 0.2)
    bench, it, joints = make(async_parameters={"time_limit": 0.002})
    bench.switch(start=["it"])
    it.set_points.post([RAISES])
    step(bench, joints)
    assert "ValueError: no solution" in bench.status("it").fault

    bench.switch(start=["it"])
    bench.manager.pump = None
    it.set_points.post([HANGS])
    step(bench, joints, 6)
    assert "takes longer than 0.002 s" in bench.status("it").fault
    # It is ended a bit later, and another one is started.
    wait_until_idle(bench)
    bench.manager.unload_controller("it")


class TakesGoals(Elsewhere):
    """Has a port for goals."""

    @override
    def init(self, interface, params):
        super().init(interface, params)
        self.goals = object()


class Local(Elsewhere):
    """Cannot be found by its name."""


Local.__qualname__ = "nowhere.Local"


def test_what_cannot_be_in_another_process_is_refused_at_loading():
    with pytest.raises(ControllerLoadError, match=r"process of its own: .*no such dev"):
        make(broken=float(STATION))
    with pytest.raises(ControllerLoadError, match="nowhere"):
        make(Local)
    with pytest.raises(ControllerLoadError, match="takes goals"):
        make(TakesGoals)
    asked = {"is_async": True, "async_parameters": {"process": True}}
    with pytest.raises(ParameterError, match="a robot has a thread"):
        AsyncRobotHW.wrap(MockRobotHW(), Parameters(ParameterTree(asked)))
