"""The content of the status strip."""

from station.ui.link.station_view import StationView
from station.ui.page.page_state import BarState, bar_state
from station.wire import ArmError, ArmReport
from tests.ui.views import status, view


def test_bar_names_the_errors_of_an_arm_and_what_to_do():
    error = ArmError(
        name="cartesian_reflex",
        where="z",
        value=30.0,
        limit=20.0,
        unit="N",
        cycle=7,
        description="",
    )
    arm = ArmReport(
        arm_id="panda",
        robot_mode="reflex",
        connected=True,
        errors=[error, error],
        remedy="recover",
    )
    found = status().model_copy(update={"robot_mode": "reflex", "robots": [arm]})

    bar = bar_state(StationView(status=found), "")

    assert bar.mode == "reflex · panda: cartesian_reflex: recover"


def test_bar_shows_mode_loop_epoch_and_stop():
    bar = bar_state(view(stop_state="stopped"), "")
    assert (bar.link, bar.mode, bar.stop_state, bar.epoch) == (
        "live",
        "idle",
        "stopped",
        1,
    )
    assert bar.robot == "SIMULATION"
    assert (bar.rate_hz, bar.lateness_p99) == (999.5, 1.5e-4)


def test_bar_claims_nothing_before_the_first_answer():
    assert bar_state(StationView(failure="No answer."), "") == BarState(
        "lost", message="No answer."
    )


def test_a_refusal_comes_before_a_failure_of_the_link():
    seen = StationView(failure="No answer.")
    assert bar_state(seen, "Refused.").message == "Refused."
