"""Gain sets over HTTP."""

import pytest

from station.client import ApiError


@pytest.fixture(autouse=True)
def own_sets(monkeypatch, tmp_path):
    """Begin without any set."""
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))


def test_a_set_is_saved_compared_applied_and_taken_back(spring):
    assert spring.gain_sets.save("soft").gains == {"spring": {"k": 2.0}}
    spring.set_gains("spring", {"k": 5.0})

    (difference,) = spring.gain_sets.get("soft").differences
    assert (difference.saved, difference.present) == (2.0, 5.0)
    change = spring.gain_sets.apply("soft")["spring"]
    assert (change.values, change.previous) == ({"k": 2.0}, {"k": 5.0})
    assert spring.gain_sets.undo()["spring"].values == {"k": 5.0}


def test_sets_are_listed_and_deleted(spring):
    spring.gain_sets.save("soft", ["spring"])
    spring.gain_sets.save("a-1")

    assert spring.gain_sets.names() == ["a-1", "soft"]
    assert spring.gain_sets.delete("soft").name == "soft"
    assert spring.gain_sets.names() == ["a-1"]


@pytest.mark.parametrize(
    ("ask", "status"),
    [
        (lambda sets: sets.get("nothing"), 404),
        (lambda sets: sets.delete("nothing"), 404),
        (lambda sets: sets.apply("nothing"), 404),
        (lambda sets: sets.save("../x"), 422),
        (lambda sets: sets.save("-"), 422),
        (lambda sets: sets.save("soft", ["nobody"]), 404),
        (lambda sets: sets.undo(), 409),
    ],
)
def test_what_is_not_possible_is_refused(spring, ask, status):
    with pytest.raises(ApiError) as caught:
        ask(spring.gain_sets)

    assert caught.value.status == status
    assert spring.gain_sets.names() == []


def test_viewers_change_no_set(http):
    http.headers["Authorization"] = "Bearer viewer-token"

    listed = http.get("/api/v1/gain-sets").json()
    assert listed == {"gain_sets": [], "undoable_changes": 0}
    for method, path in (
        ("PUT", "/x"),
        ("DELETE", "/x"),
        ("POST", "/x/apply"),
        ("POST", "/undo"),
    ):
        assert http.request(method, f"/api/v1/gain-sets{path}").status_code == 403
