"""The log of what was asked of a station."""

from station.core.control.switching import SwitchRequest
from station.core.facade import input_log
from tests.api.spring import make_station
from tests.two_joint_station import TRAJECTORY, make_station as make_trajectory_station


def _kinds(station):
    return [(one.kind, one.after()) for one in station.inputs.take_inputs()]


def test_inputs_are_noted_with_the_last_cycle_before_them():
    station = make_station()
    station.load_controller("arm", "test/Spring", {"joint": "j"})
    station.loop.step(3)
    station.switch_controllers(SwitchRequest(start=["arm"]))
    station.loop.step()
    station.motion.set_command("arm", [0.5])
    station.tuning.set_gains("arm", {"k": 3.0})
    station.loop.step(2)
    station.stop("why")
    station.release_stop(arm=False)

    assert _kinds(station) == [
        ("load", 0), ("switch", 3), ("set_point", 5), ("gains", 5), ("stop", 7),
        ("release", 7),
    ]  # fmt: skip
    assert _kinds(station) == []


def test_a_replaced_set_point_has_no_cycle():
    station = make_station()
    station.load_controller("arm", "test/Spring", {"joint": "j"})
    station.switch_controllers(SwitchRequest(start=["arm"]))
    station.inputs.take_inputs()
    station.motion.set_command("arm", [0.5])
    station.motion.set_command("arm", [0.6])
    station.loop.step()

    first, second = station.inputs.take_inputs()
    assert (first.after(), second.after()) == (None, 1)
    assert second.arguments["values"] == [0.6]


def test_a_dry_run_and_what_is_refused_are_no_inputs():
    station = make_station()
    station.load_controller("arm", "test/Spring", {"joint": "j"})
    station.inputs.take_inputs()
    station.switch_controllers(SwitchRequest(start=["arm"], dry_run=True))

    assert _kinds(station) == []


def test_inputs_that_nobody_takes_are_dropped_and_that_is_told():
    station = make_station()
    for _ in range(input_log.CAPACITY + 1):
        station.inputs.note("release", arm=True)

    assert not station.inputs.is_complete
    assert len(station.inputs.take_inputs()) == input_log.CAPACITY


def test_a_set_point_that_expires_is_noted_with_its_cycle():
    station = make_station()
    station.load_controller("arm", "test/Spring", {"joint": "j"})
    station.switch_controllers(SwitchRequest(start=["arm"]))
    port = station.manager.get_controller("arm").set_points
    station.inputs.take_inputs()
    station.motion.set_command("arm", [0.5])
    station.loop.step(3)
    port.expire()
    (one,) = station.inputs.take_inputs()
    assert one.until() is None

    station.loop.step()
    port.take_expiry()

    assert (one.after(), one.until()) == (1, 4)


def test_a_plan_is_noted_with_the_time_of_its_cycle():
    station = make_trajectory_station()
    station.loop.step()
    station.switch_controllers(SwitchRequest(start=["arm"]))
    station.loop.step(3)
    station.inputs.take_inputs()
    goal = station.motion.submit_goal("arm", {"trajectory": TRAJECTORY})
    planned = station.loop.time
    station.loop.step(10)
    station.motion.cancel_goal("arm", goal.identifier)
    cycle = station.loop.cycle
    station.loop.step()

    sent, cancelled = station.inputs.take_inputs()
    assert sent.arguments["planned_at"] == planned
    assert (sent.kind, sent.after()) == ("goal", cycle - 10)
    assert (cancelled.kind, cancelled.after()) == ("cancel_goal", cycle)
