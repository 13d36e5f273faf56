"""A set of run-time parameters is allowed as a whole or not at all."""

import pytest

from station.core.control.tunables import Tunable, Tunables
from station.core.errors import InvalidGainError

SCHEMA = {"p": Tunable("Nm/rad", 0.0, 100.0), "d": Tunable("", -1.0, 1.0)}
CURRENT = {"p": 10.0, "d": 0.0}


def test_changes_are_merged_into_the_present_values():
    assert Tunables(SCHEMA, CURRENT).checked({"p": 20}) == {"p": 20, "d": 0.0}


def test_limits_are_allowed():
    assert Tunables(SCHEMA, CURRENT).checked({"p": 100.0, "d": -1.0})["d"] == -1.0


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("p", 101.0, "allowed is 0.0 to 100.0 Nm/rad"),
        ("p", -0.1, "allowed is"),
        ("p", float("nan"), "allowed is"),
        ("p", float("inf"), "allowed is"),
        ("p", True, "must be a number"),
        ("p", "600", "must be a number"),
        ("q", 1.0, "unknown; known are p, d"),
    ],
)
def test_anything_else_is_refused_by_name(name, value, words):
    with pytest.raises(InvalidGainError, match=f"'{name}'.*{words}") as caught:
        Tunables(SCHEMA, CURRENT).checked({name: value})

    (error,) = caught.value.details["errors"]
    assert error["field"] == name


def test_all_problems_are_listed():
    with pytest.raises(InvalidGainError, match="1 more") as caught:
        Tunables(SCHEMA, CURRENT).checked({"p": -1.0, "q": 0.0, "d": 0.5})

    assert [e["field"] for e in caught.value.details["errors"]] == ["p", "q"]
    assert CURRENT == {"p": 10.0, "d": 0.0}
