"""The parts of Viser's panel: widgets, groups of gains, and words."""

import pytest

from station.ui.teleoperation.viser_panel import (
    GENERAL,
    NONE,
    FollowingSlider,
    bases_of_hands,
    gain_groups,
    gain_label,
    good,
    hint,
    set_options,
    set_value,
    tunable_controllers,
    warning,
)
from tests.ui.views import controller, view

ARMS = ("left", "right")


@pytest.fixture
def gui(bench):
    gui = bench.guarded.server.gui
    with gui.add_folder("Widgets under test") as folder:
        yield gui
    folder.remove()


def test_the_chosen_name_stays_chosen_while_the_dropdown_offers_it(gui):
    dropdown = gui.add_dropdown("Which", (NONE,))
    set_options(dropdown, ("a", "b"))
    set_value(dropdown, "b")
    set_options(dropdown, ("c", "b"))
    assert dropdown.value == "b"
    set_options(dropdown, ("c",))
    assert dropdown.value == "c"


def test_a_dropdown_without_names_is_disabled(gui):
    dropdown = gui.add_dropdown("Which", (NONE,))
    set_options(dropdown, ())
    assert dropdown.disabled
    assert dropdown.value == NONE


def test_a_slider_follows_until_a_person_moves_it(gui):
    slider = gui.add_slider("p", min=0.0, max=9.0, step=0.1, initial_value=1.0)
    following = FollowingSlider(slider)
    following.show(2.0)
    assert slider.value == 2.0

    set_value(slider, 5.0)  # as a browser's message does, before its callback runs
    following.show(2.5)
    assert slider.value == 5.0
    assert following.is_moved()


def test_a_slider_follows_again_once_the_change_is_taken_up(gui):
    slider = gui.add_slider("p", min=0.0, max=9.0, step=0.1, initial_value=1.0)
    following = FollowingSlider(slider)
    set_value(slider, 5.0)
    following.taken()
    following.show(6.0)
    assert slider.value == 6.0


def test_running_controllers_come_first_and_controllers_without_claims_are_left_out():
    seen = view(
        controller("a"), controller("b", "running"), controller("state", joints=[])
    )
    assert tunable_controllers(seen) == ["b", "a"]


def test_gains_are_grouped_by_joint():
    groups = gain_groups(["joint1/p", "joint1/d", "joint2/p", "stiffness"])
    assert groups == {
        "joint1": ["joint1/p", "joint1/d"],
        "joint2": ["joint2/p"],
        GENERAL: ["stiffness"],
    }


@pytest.mark.parametrize(
    ("name", "unit", "label"),
    [("joint1/p", "Nm/rad", "p [Nm/rad]"), ("joint1/i_clamp", "", "i clamp")],
)
def test_a_label_has_the_unit(name, unit, label):
    assert gain_label(name, unit) == label


@pytest.mark.parametrize(
    ("arms", "bases", "expected"),
    [
        ([], [], {"": ""}),
        (["panda"], ["/robot/a"], {"": "/robot/a"}),
        (ARMS, ["/robot/a", "/robot_2/a"], {"left": "/robot/a", "right": "/robot_2/a"}),
        (ARMS, ["/robot/a"], {"left": "/robot/a", "right": ""}),
    ],
)
def test_each_target_is_drawn_at_the_base_of_its_arm(arms, bases, expected):
    assert bases_of_hands(arms, bases) == expected


def test_words_are_escaped():
    assert all("<i>" not in make("<i>") for make in (hint, warning, good))
