"""Asynchronous controllers: the cycle never waits, and stepped cycles are the same."""

import threading

import pytest
from typing_extensions import override

from station.core.control.controller import Controller, ControllerState
from station.core.control.tunables import Tunable, Tunables
from station.core.errors import ControllerLoadError
from station.core.hardware.interfaces import EffortJointInterface
from station.core.ports.command_ticket import CommandTicket
from station.testing.bench import Bench
from tests.waiting import PATIENCE, wait_until


class Slow(Controller[EffortJointInterface]):
    """Commands the position that it has seen; its test holds it up."""

    hardware_interface = EffortJointInterface

    @override
    def init(self, interface, params):
        self.joint = interface.get_handle("j1")
        self.seen, self.calls = [], []
        self.go, self.begun, self.ended = (threading.Semaphore(0) for _ in range(3))
        self.is_held = False
        self.error = self.ticket = None
        self.gains = []
        self.tunables = Tunables(
            {"gain": Tunable("", 0.0, 9.0, "What it notes.")}, {"gain": 1.0}
        )

    @override
    def update(self, time, period):
        self.begun.release()
        if self.is_held:
            assert self.go.acquire(timeout=PATIENCE)
        self.seen.append((round(time, 6), round(period, 6)))
        self.gains.append(self.tunables.values["gain"])
        if self.ticket is not None:
            self.ticket.accept()
        if self.error is not None:
            raise self.error
        self.joint.set_command(self.joint.get_position())
        self.ended.release()

    @override
    def stopping(self, time):
        self.calls.append(threading.current_thread().name)
        self.ended.release()


def make(**parameters):
    bench = Bench(robot_parameters={"joints": ["j1"]}, period=0.001)
    bench.load_controller("slow", Slow, is_async=True, **parameters)
    bench.switch(start=["slow"])
    return bench, bench.manager.get_controller("slow"), bench.robot.joints


def command(bench):
    (guard,) = bench.manager.lifecycle.find("slow").commands.guards
    storage, index = guard.slots[0]
    return storage[index]


def step(bench, positions, joints):
    """Run a cycle per position, and return the commands after each."""
    found = []
    for position in positions:
        joints.position[0] = position
        bench.step()
        found.append(command(bench))
    return found


def test_a_result_counts_after_the_declared_cycles_in_a_stepped_station():
    bench, slow, joints = make(async_parameters={"cycles": 2})

    found = step(bench, [0.01, 0.02, 0.03, 0.04, 0.05], joints)

    assert found == [0.0, 0.0, 0.01, 0.01, 0.03]
    assert [period for _, period in slow.seen] == [0.001, 0.002, 0.002]
    assert bench.status("slow").async_update.age == 2


def test_a_cycle_does_not_wait_for_an_update_and_tells_its_age():
    bench, slow, joints = make()
    bench.manager.pump = None  # as with a loop that runs
    slow.is_held = True

    assert step(bench, [0.01], joints) == [0.0]
    assert slow.begun.acquire(timeout=PATIENCE)
    assert step(bench, [0.02, 0.03, 0.04], joints) == [0.0, 0.0, 0.0]

    statistics = bench.status("slow").async_update
    assert (statistics.age, statistics.missed) == (4, 3)
    slow.is_held = False
    slow.go.release()
    assert slow.ended.acquire(timeout=PATIENCE)
    wait_until_idle(bench)
    assert step(bench, [0.05], joints) == [0.01]
    bench.manager.stop_all(bench.time)


def wait_until_idle(bench):
    """Wait until the thread waits for the next update, giving way only."""
    beside = bench.manager.lifecycle.find("slow").beside
    assert wait_until(lambda: not (beside._is_busy or beside._is_ending), pause=0.0), (
        "the update does not end"
    )


def test_an_update_over_its_time_limit_stops_the_controller_alone():
    bench, slow, joints = make(async_parameters={"time_limit": 0.002})
    bench.manager.pump = None
    slow.is_held = True

    step(bench, [0.01] * 6, joints)

    status = bench.status("slow")
    assert status.state is ControllerState.ABORTED
    assert "takes longer than 0.002 s" in status.fault
    slow.go.release()


def test_what_an_update_reads_counts_from_the_cycle_in_which_it_began():
    bench, slow, joints = make()
    bench.manager.pump = None
    slow.is_held = True
    slow.ticket = CommandTicket(lambda: bench.manager.cycle)
    step(bench, [0.01], joints)
    begun = bench.manager.cycle
    assert slow.begun.acquire(timeout=PATIENCE)
    step(bench, [0.02, 0.03], joints)
    # A change in the meantime is for the next update.
    slow.tunables.apply({"gain": 2.0})
    slow.tunables.apply(slow.tunables.checked({"gain": 3.0}))
    slow.go.release()
    assert slow.ended.acquire(timeout=PATIENCE)
    assert slow.ticket.accepted_cycle == begun == bench.manager.cycle - 2
    assert slow.gains == [1.0]
    wait_until_idle(bench)
    slow.is_held = False
    step(bench, [0.04], joints)
    assert slow.begun.acquire(timeout=PATIENCE)
    assert slow.ended.acquire(timeout=PATIENCE)
    assert slow.gains == [1.0, 3.0]
    bench.manager.stop_all(bench.time)


def test_what_an_update_raises_stops_the_controller():
    bench, slow, joints = make()
    slow.error = RuntimeError("no solution")

    step(bench, [0.01, 0.02], joints)

    assert "no solution" in bench.status("slow").fault


def test_a_keyboard_interrupt_of_a_library_stops_the_controller():
    bench, slow, joints = make()
    bench.manager.pump = None  # as with a loop that runs
    slow.error = KeyboardInterrupt()
    step(bench, [0.01], joints)
    assert slow.begun.acquire(timeout=PATIENCE)
    wait_until_idle(bench)

    step(bench, [0.02, 0.03], joints)

    assert "KeyboardInterrupt" in bench.status("slow").fault


def test_stopping_waits_for_the_update_in_its_thread_and_the_cycle_does_not():
    bench, slow, joints = make()
    slow.is_held = True
    bench.manager.pump = None
    step(bench, [0.01], joints)
    assert slow.begun.acquire(timeout=PATIENCE)

    bench.manager.stop_all(bench.time)
    assert slow.calls == []
    slow.go.release()
    assert slow.ended.acquire(timeout=PATIENCE)
    assert slow.ended.acquire(timeout=PATIENCE)

    assert slow.calls == ["async Slow"]
    assert command(bench) == joints.position[0] * 0.0


def test_its_rate_is_that_of_its_updates():
    bench, slow, joints = make(update_rate=250)

    step(bench, [0.01] * 8, joints)

    assert [period for _, period in slow.seen] == [0.001, 0.004]
    assert bench.status("slow").update_rate == 250.0


def test_a_robot_itself_cannot_be_read_beside_the_cycle():
    class Odd:
        """An interface that is no set of handles."""

    class Reader(Slow):
        hardware_interface = Odd

        @override
        def init(self, interface, params):
            """Read nothing."""

    bench = Bench(robot_parameters={"joints": ["j1"]}, period=0.001)
    bench.robot.register_interface(Odd())

    with pytest.raises(ControllerLoadError, match="belongs to the control thread"):
        bench.load_controller("odd", Reader, is_async=True)
