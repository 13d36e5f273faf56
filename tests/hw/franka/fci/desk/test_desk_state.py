"""Control passes from one to the next, and end effectors are kept."""

from math import inf, nan, pi

import pytest

from station.core.description.urdf import Pose
from station.hw.franka.arm.franka_kinematics import IDENTITY
from station.hw.franka.arm.rigid_body import RigidBody
from station.hw.franka.fci.desk.desk_state import (
    MOUNTED,
    NO_END_EFFECTOR,
    DeskRefusalError,
    load_of,
    profile_of,
)
from station.hw.franka.simulated.end_effector import as_transform
from tests.hw.franka.fci.desk.desk_bench import HAND


def test_first_client_has_control_and_the_next_waits_for_it(desk):
    ada, ben = desk.request_control("ada"), desk.request_control("ben")
    desk.check_control(ada.secret)
    with pytest.raises(DeskRefusalError, match="not the active one") as refused:
        desk.check_control(ben.secret)
    assert refused.value.status == 423
    desk.release_control(ada.secret)
    desk.check_control(ben.secret)
    desk.release_control(ben.secret)
    assert desk.token is None


def test_client_that_waited_too_long_ago_gets_nothing(desk):
    ada = desk.request_control("ada")
    desk.request_control("gone")
    desk.now.seconds += 61.0
    eve = desk.request_control("eve")
    desk.release_control(ada.secret)
    assert desk.token == eve


def test_forced_control_replaces_the_one_before(desk):
    desk.request_control("ada")
    ben = desk.request_control("ben", is_forced=True)
    assert desk.token == ben


def test_token_of_nobody_cannot_be_given_back(desk):
    with pytest.raises(DeskRefusalError):
        desk.release_control("guessed")


def test_brakes_and_fci_reach_the_arm(desk):
    desk.set_brakes(closed=False)
    desk.set_fci(active=True)
    assert desk.arm.changes == [("brakes", False), ("fci", True)]
    desk.reboot()
    assert desk.arm.changes[2:] == [("fci", False), ("brakes", True)]
    assert (desk.are_brakes_closed, desk.is_fci_active) == (True, False)


def test_programming_ends_fci_and_refuses_it(desk):
    desk.set_fci(active=True)
    desk.change_mode("programming")
    assert desk.arm.changes[-1] == ("fci", False)
    with pytest.raises(DeskRefusalError, match="Execution") as refused:
        desk.set_fci(active=True)
    assert refused.value.status == 424
    desk.change_mode("Execution")
    desk.set_fci(active=True)
    with pytest.raises(DeskRefusalError, match="no operating mode"):
        desk.change_mode("dreaming")


def test_profile_is_its_load_and_its_frame():
    turn = Pose.from_rpy((0.1, 0.2, 0.3), (0.3, -0.5, pi / 3))
    frame = as_transform(turn)
    load, found = load_of(profile_of("tool", HAND, frame))
    assert load == HAND
    assert found == pytest.approx(frame, abs=1e-12)


def test_desks_own_profiles_stay_and_the_active_one_is_not_deleted(desk):
    pen = desk.save_profile(None, profile_of("pen", RigidBody(0.1), (1.0,) * 16))
    desk.activate_profile(pen["id"])
    assert desk.arm.changes[-1][:2] == ("end effector", RigidBody(0.1))
    assert desk.find_profile(pen["id"])["active"] is True
    for name in (pen["id"], MOUNTED, NO_END_EFFECTOR):
        with pytest.raises(DeskRefusalError):
            desk.delete_profile(name)
    desk.activate_profile(NO_END_EFFECTOR)
    desk.delete_profile(pen["id"])
    with pytest.raises(DeskRefusalError, match="no profile") as refused:
        desk.find_profile(pen["id"])
    assert refused.value.status == 404


@pytest.mark.parametrize("missing", ["inertial", "tcp"])
def test_profile_with_a_hole_is_refused(desk, missing):
    profile = profile_of("pen", HAND, (1.0,) * 16)
    del profile[missing]
    with pytest.raises(DeskRefusalError, match="not complete"):
        desk.save_profile(None, profile)


@pytest.mark.parametrize("mass", [nan, inf, -0.1, 1e39])
def test_end_effector_that_cannot_be_is_refused(desk, mass):
    profile = profile_of("pen", HAND, IDENTITY)
    profile["inertial"]["mass"] = mass
    with pytest.raises(DeskRefusalError, match="not complete or not possible"):
        desk.save_profile(None, profile)
