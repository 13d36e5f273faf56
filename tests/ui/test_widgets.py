"""Setting Viser's widgets from the dashboard's side."""

import pytest

from station.ui.widgets import NONE, set_options, set_value


@pytest.fixture
def gui(bench):
    gui = bench.guarded.server.gui
    with gui.add_folder("Widgets under test") as folder:
        yield gui
    folder.remove()


def test_a_choice_stays_while_it_is_offered(gui):
    dropdown = gui.add_dropdown("Which", (NONE,))
    set_options(dropdown, ("a", "b"))
    set_value(dropdown, "b")
    set_options(dropdown, ("c", "b"))
    assert dropdown.value == "b"
    set_options(dropdown, ("c",))
    assert dropdown.value == "c"


def test_nothing_to_choose_greys_the_dropdown(gui):
    dropdown = gui.add_dropdown("Which", (NONE,))
    set_options(dropdown, ())
    assert dropdown.disabled
    assert dropdown.value == NONE
