"""From the core's values to the wire: nothing is lost, nothing is infinite."""

import math

import pytest

from station.api import wire
from station.core.control.controller import ControllerSample
from station.core.control.switching import SwitchPlan, SwitchRequest, SwitchResult
from station.core.control.tunables import Gains, Tunable
from station.core.ports.set_point import SetPoint, SetPointElement
from tests.api.spring import make_station


@pytest.fixture
def station():
    station = make_station()
    station.load_controller("spring", "test/Spring", {"joint": "j"})
    station.switch_controllers(SwitchRequest(start=("spring",)))
    station.loop.step()
    return station


@pytest.mark.parametrize(
    ("value", "told"), [(1.5, 1.5), (math.inf, None), (math.nan, None)]
)
def test_what_is_not_finite_becomes_none(value, told):
    assert wire.measured(value) == told
    assert wire.measured_list([value, 0.0]) == [told, 0.0]


def test_unlimited_set_points_have_no_bounds():
    element = SetPointElement("j", "rad")

    info = wire.command_info(SetPoint((element,), (math.nan,)))

    assert info.elements[0].minimum is None
    assert info.elements[0].maximum is None
    assert info.last == [None]
    assert wire.command_info(SetPoint((element,), None)).last is None


def test_unlimited_gains_have_no_bounds():
    gains = wire.gains(Gains({"p": 1.0}, {"p": Tunable("", 0.0, math.inf)}, 3), '"e"')

    assert gains.tunables["p"].maximum is None
    assert (gains.revision, gains.etag) == (3, '"e"')


def test_a_sample_with_holes():
    sample = ControllerSample(0.1, [math.nan], [1.0], [math.nan], [2.0])

    told = wire.controller_sample(sample, ["j"])

    assert (told.desired, told.actual, told.output) == ([None], [1.0], [2.0])


def test_a_switch_tells_what_failed_and_what_was_left_out():
    plan = SwitchPlan((), (), (), (), (), ignored=("b is unknown",))
    result = SwitchResult(
        ok=False,
        started=("a",),
        stopped=(),
        cycle=7,
        plan=plan,
        failed={"c": "why"},
        jump={"j": math.inf},
    )

    told = wire.switch_result(result)

    assert told.failed == {"c": "why"}
    assert told.ignored == ["b is unknown"]
    assert told.jump == {"j": None}
    assert not told.dry_run


def test_controllers(station):
    (spring,) = wire.controllers(station).controllers

    assert spring.state == "running"
    assert spring.claimed_resources[0].resources == ["j"]
    assert spring.time.count >= 0


def test_status_loop_stop_and_joints(station):
    status = wire.status(station, {"station": "1"})

    assert status.loop.cycles == station.loop.cycle
    assert wire.stop_state(station).state == status.stop_state == "armed"
    states = wire.joint_states(station.latest(), station.joint_names)
    assert states.stamp == status.time
