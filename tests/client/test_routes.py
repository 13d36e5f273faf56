"""How paths are written."""

import pytest

from station.client.routes import segment


@pytest.mark.parametrize(
    ("name", "written"),
    [
        ("arm", "arm"),
        ("a/b c", "a%2Fb%20c"),
        ("x&y?", "x%26y%3F"),
        ("a.b-c_1", "a.b-c_1"),
    ],
)
def test_a_name_is_one_segment_of_a_path(name, written):
    assert segment(name) == written
