"""Setting Viser's widgets from the dashboard's side."""

import pytest

from station.ui.widgets import NONE, FollowingSlider, set_options, set_value


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
