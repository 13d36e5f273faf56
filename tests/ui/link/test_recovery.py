"""The recovery that the page offers, and why."""

import pytest

from station.ui.link.station_view import StationView, choose_recovery
from station.wire import ArmError
from tests.ui.views import arm, status

HIT = ArmError(
    name="cartesian_reflex",
    where="z",
    value=-30.0,
    limit=20.0,
    unit="N",
    cycle=7,
    description="cartesian_reflex at z: -30 N",
)


def view(*arms, age=0.0):
    return StationView(now=10.0, heard_at=10.0 - age, status=status(robots=arms))


@pytest.mark.parametrize("mode", ["idle", "move"])
def test_without_an_error_there_is_nothing_to_do(mode):
    rescue = choose_recovery(view(arm("panda", mode)))
    assert (rescue.action, rescue.trouble) == ("", "")
    assert rescue.reason == "Nothing to recover: no arm has an error."


def test_arm_in_reflex_can_be_recovered_and_its_error_is_shown():
    reflex = arm("left", "reflex", "recover", [HIT, HIT, HIT, HIT])
    rescue = choose_recovery(view(reflex, arm("right", "idle")))
    assert (rescue.action, rescue.label) == ("recover", "Recover left")
    assert rescue.trouble.startswith("left stopped itself: cartesian_reflex at z: -30")
    assert rescue.trouble.endswith("1 more")
    assert "Nothing moves by itself" in rescue.reason


def test_user_stop_is_released_before_anything_is_recovered():
    rescue = choose_recovery(
        view(arm("left", "user_stopped", "release"), arm("right", "reflex", "recover"))
    )
    assert (rescue.action, rescue.arms) == ("release", ("left",))
    assert rescue.label == "Release the user stop of left"


def test_an_arm_that_cannot_be_recovered_from_the_dashboard_shows_why():
    rescue = choose_recovery(view(arm("panda", "other", "reset the simulation")))
    assert rescue.action == ""
    assert rescue.trouble == "panda is in mode other."
    assert "panda: reset the simulation" in rescue.reason


def test_no_recovery_is_offered_while_the_link_is_stale():
    rescue = choose_recovery(view(arm("panda", "reflex", "recover"), age=1.0))
    assert (rescue.action, rescue.reason) == ("", "The link to the station is stale.")
