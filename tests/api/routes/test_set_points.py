"""Set-points: taken whole by a running controller, or refused."""

import pytest

from station.api.auth import Access, Role
from station.client import ApiError
from station.core.clock import ManualClock
from station.core.ports.set_point import SetPointElement
from station.events import Origin
from station.wire.excitations import Step
from tests.api.test_errors import problem_of
from tests.for_each import for_each
from tests.patient_clock import PatientClock

COMMAND = "/api/v1/controllers/spring/command"


def test_a_set_point_reaches_the_controller(spring, station):
    assert spring.command("spring", [0.5]).epoch == 1
    station.loop.step()

    info = spring.last_command("spring")
    assert info.last == [0.5]
    assert [(e.name, e.unit, e.minimum, e.maximum) for e in info.elements] == [
        ("j", "rad", -1.0, 1.0)
    ]
    state = spring.controller_state("spring")
    assert state.name == ["j"]
    assert state.desired == [0.5]
    assert state.actual == [0.25]
    assert state.output == [0.5]


def test_null_leaves_an_element_at_what_the_controller_was_told(spring, station):
    spring.command("spring", [0.5])
    spring.command("spring", [None])
    station.loop.step()
    assert spring.last_command("spring").last == [0.5]


@pytest.mark.alone  # it waits for a running loop
def test_the_answer_says_which_cycle_was_the_first_with_it(live, station):
    live.load_controller("spring", "test/Spring", {"joint": "j"})
    live.switch_controllers(start=["spring"])
    assert live.command("spring", [0.4]).cycle is None  # the loop is stepped by hand

    controller = station.manager.get_controller("spring")
    targets = {}
    real = controller.update

    def update(*time):
        real(*time)
        targets.setdefault(controller.target, station.loop.cycle)

    controller.update = update
    station.loop.clock = PatientClock()
    station.loop.start()
    try:
        answers = [live.command("spring", [value]) for value in (0.5, 0.6)]
    finally:
        station.loop.stop()
    assert [answer.cycle for answer in answers] == [targets[0.5], targets[0.6]]


@for_each(
    "body, status, code",
    [
        ('{"command": [NaN]}', 422, "invalid_request"),
        ('{"command": [Infinity]}', 422, "invalid_request"),
        ('{"command": [-Infinity]}', 422, "invalid_request"),
        ('{"command": ["abc"]}', 422, "invalid_request"),
        ('{"command": ["0.5"]}', 422, "invalid_request"),
        ('{"command": [true]}', 422, "invalid_request"),
        ('{"command": [[0.5]]}', 422, "invalid_request"),
        ('{"command": 0.5}', 422, "invalid_request"),
        ('{"command": "abc"}', 422, "invalid_request"),
        ('{"command": {"j": 0.5}}', 422, "invalid_request"),
        ('{"commands": [0.5]}', 422, "invalid_request"),
        ("{}", 422, "invalid_request"),
        ('{"command": [0.5], "epoch": "1"}', 422, "invalid_request"),
        ('{"command": [0.5], "epoch": 1.5}', 422, "invalid_request"),
        ('{"command": [0.5], "epoch": true}', 422, "invalid_request"),
        ('{"command": [0.5], "timeout": -1}', 422, "invalid_request"),
        ('{"command": [0.5], "timeout": NaN}', 422, "invalid_request"),
        ('{"command": [0.5], "rates": ["1"]}', 422, "invalid_request"),
        ('{"command": [0.5], "rates": [0.1]}', 422, "invalid_command"),
        ('{"command": []}', 422, "invalid_command"),
        ('{"command": [0.5, 0.5]}', 422, "invalid_command"),
        ('{"command": [1.01]}', 422, "invalid_command"),
        ('{"command": [1e300]}', 422, "invalid_command"),
        ('{"command": [0.5], "epoch": 0}', 409, "stale_epoch"),
    ],
)
def test_a_malformed_set_point_changes_nothing(
    spring, operator, station, body, status, code
):
    answer = operator.put(
        COMMAND, content=body, headers={"Content-Type": "application/json"}
    )

    problem_of(answer, status, code)
    station.loop.step()
    assert spring.last_command("spring").last is None
    assert spring.controller_state("spring").desired == [0.25]


@pytest.mark.usefixtures("spring")
def test_a_body_that_is_not_declared_json_is_refused(operator):
    answer = operator.put(COMMAND, content='{"command": [0.5]}')

    problem_of(answer, 415, "unsupported_media_type")


def test_a_stopped_controller_refuses_set_points(spring):
    spring.switch_controllers(stop=["spring"])

    with pytest.raises(ApiError) as caught:
        spring.command("spring", [0.5])

    assert (caught.value.status, caught.value.code) == (409, "controller_state")


def test_a_set_point_from_before_a_stop_is_void(spring):
    epoch = spring.status().epoch
    spring.stop()
    spring.release_stop()
    spring.release_stop(arm=True)
    spring.switch_controllers(start=["spring"])

    with pytest.raises(ApiError) as caught:
        spring.command("spring", [0.5], epoch)

    assert (caught.value.status, caught.value.code) == (409, "stale_epoch")


def test_a_set_point_may_be_valid_for_a_while(spring, station):
    port = station.manager.get_controller("spring").set_points
    port.clock = clock = ManualClock()

    spring.command("spring", [0.5], timeout=0.2)
    station.loop.step()

    clock.advance(0.19)
    assert not port.take_expiry()
    clock.advance(0.02)
    assert port.take_expiry()


def test_rates_reach_a_controller_that_feeds_them_forward(spring, station):
    port = station.manager.get_controller("spring").set_points
    port.feed_forward = [SetPointElement("j", "rad/s", -1.0, 1.0)]

    spring.command("spring", [0.5], rates=[0.25])
    station.loop.step()

    assert port.last == [0.5, 0.25]
    assert spring.last_command("spring").last == [0.5]


def test_a_controller_that_has_not_run_has_no_state(client):
    client.load_controller("spring", "test/Spring", {"joint": "j"})

    with pytest.raises(ApiError) as caught:
        client.controller_state("spring")

    assert (caught.value.status, caught.value.code) == (409, "no_sample")


def test_a_controller_that_only_publishes_has_its_messages_as_state(spring, station):
    controller = station.manager.get_controller("spring")
    controller.sample = None
    message = {"stamp": 0.5, "force": [1.0, float("nan"), 2.0], "frame_id": "hand"}
    controller.published = lambda: {"wrist": message}

    state = spring.controller_state("spring")

    assert state.name == state.desired == []
    assert state.published == {"wrist": message | {"force": [1.0, None, 2.0]}}


@pytest.mark.parametrize("ask", ["command", "last_command", "controller_state"])
def test_an_unknown_controller(spring, ask):
    arguments = ([0.5],) if ask == "command" else ()

    with pytest.raises(ApiError) as caught:
        getattr(spring, ask)("nobody", *arguments)

    assert (caught.value.status, caught.value.code) == (404, "controller_not_found")


def test_a_set_point_under_way_at_a_take_over_does_not_land(spring, station, app):
    control, motion = app.state.services.control, station.motion
    make_ticket = motion.ticket

    def ticket_and_take_over():
        access = Access(Role.OPERATOR)
        control.take(access, None, "Grace", 10.0, force=True, origin=Origin())
        return make_ticket()

    with spring.control(owner="Ada"):
        motion.ticket = ticket_and_take_over  # after the first check, before the post
        with pytest.raises(ApiError, match="Grace holds control") as refused:
            spring.command("spring", [0.5])
        station.loop.step()

    assert refused.value.status == 423
    assert spring.last_command("spring").last != [0.5]


def test_what_the_bench_refuses_moves_nothing(spring, station):
    """The joint of this robot never moves; what is measured is tried with an arm."""
    station.loop.step()

    with pytest.raises(ApiError, match=r"'j' would go 0\.5 rad; allowed") as caught:
        spring.bench("spring", Step(joint="j", amplitude=0.5))

    assert (caught.value.status, caught.value.code) == (422, "impossible_range")
    assert spring.last_command("spring").last is None
