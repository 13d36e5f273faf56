"""The audit names who is behind a request; `routes/test_events.py` tries the rest."""

import pytest
from starlette.requests import HTTPConnection

from station.api.audit import WHO, mark_of, origin_of, words_of


def connection(state):
    return HTTPConnection({
        "type": "http",
        "headers": [],
        "client": ("10.0.0.7", 40000),
        "state": state,
    })


def test_a_request_that_proved_its_access_has_a_name():
    origin = origin_of(connection({WHO: "viewer"}))

    assert (origin.who, origin.where) == ("viewer", "10.0.0.7")


def test_a_request_that_proved_nothing_has_an_address_alone():
    origin = origin_of(connection({}))

    assert (origin.who, origin.where) == ("", "10.0.0.7")


@pytest.mark.parametrize(
    ("what", "words"),
    [
        ("POST /stop/release", "released the stop, or allowed motion."),
        ("PATCH /controllers/arm/gains", "changed gains of arm."),
        ("POST /gain-sets/undo", "took back the last change of gains."),
        ("PUT /robots/panda/ee_frame", "set ee_frame of panda."),
        (
            "POST /robots/panda/gripper/grasp",
            "commanded the gripper of panda to grasp.",
        ),
        ("POST /robots/error_recovery", "recovered the robot."),
        ("POST /robots/left/error_recovery", "recovered the robot."),
        ("POST /controllers/arm/bench", "tested a joint."),
        ("DELETE /control", "gave back control."),
    ],
)
def test_a_request_is_told_by_what_it_did(what, words):
    assert words_of(what, "ada", "200", is_done=True) == f"ada {words}"


def test_a_refused_request_is_told_by_what_it_did_not_do_and_why():
    words = words_of("DELETE /controllers/arm", "ada", "409 busy", is_done=False)
    assert words == "ada could not unload arm (409 busy)."


def test_a_request_without_words_is_told_by_its_route():
    words = words_of("POST /new/thing", "ada", "200", is_done=True)
    assert words == "POST /new/thing of ada was carried out."
    words = words_of("POST /new/thing", "ada", "404 unknown", is_done=False)
    assert words == "POST /new/thing of ada was refused: 404 unknown."


def test_changes_of_what_is_measured_are_marked_in_plots():
    assert mark_of("POST /gain-sets/stiff/apply") == "gain set stiff"
    assert mark_of("POST /robots/left/error_recovery") == "recovery"
    assert mark_of("POST /stop") is None
