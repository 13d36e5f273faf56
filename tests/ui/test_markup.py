"""HTML of the panels."""

from station.ui.markup import controller_table, good, hint, warning
from tests.ui.views import controller


def test_texts_of_the_station_are_escaped():
    table = controller_table([controller("<script>", joints=["<b>"])])
    assert "<script>" not in table
    assert "<b>:" not in table
    assert "&lt;script&gt;" in table


def test_the_table_has_name_state_claims_and_fault():
    broken = controller("arm", "aborted").model_copy(update={"fault": "NaN came out"})
    table = controller_table([broken])
    for word in ("arm", "aborted", "EffortJoint: joint1…3", "NaN came out"):
        assert word in table


def test_a_table_without_rows_shows_a_hint():
    assert "No controller is loaded" in controller_table([])


def test_lines_are_escaped():
    assert all("<i>" not in make("<i>") for make in (hint, warning, good))
