"""Names that a page states are those of the code."""

import re
from pathlib import Path

from station import client
from station.records.recording_table import CYCLE_COLUMNS

DOCS = Path(__file__).parents[2] / "docs"


def test_the_columns_of_a_table_have_the_order_of_the_page():
    stated = ", ".join(f"`{name}`" for name in CYCLE_COLUMNS)

    assert f"{stated}, then one column" in (DOCS / "recordings.md").read_text()


def test_what_sets_the_latest_begin_of_a_change_can_be_imported():
    (name,) = re.findall(
        r"`begin_within\((\w+)\(3\.0\)\)`", (DOCS / "api.md").read_text()
    )

    assert hasattr(client, name)
