"""A set of run-time parameters is allowed as a whole or not at all."""

import pytest

from station.core.control.tunables import Tunable, Tunables
from station.core.errors import InvalidGainError

SCHEMA = {"p": Tunable("Nm/rad", 0.0, 100.0), "d": Tunable("", -1.0, 1.0)}
CURRENT = {"p": 10.0, "d": 0.0}


def test_changes_are_merged_into_the_present_values():
    assert Tunables(SCHEMA, CURRENT).checked({"p": 20}) == {"p": 20, "d": 0.0}


def test_values_at_the_ends_of_a_range_are_allowed():
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
        ("q", 1.0, "unknown. There are: p, d"),
    ],
)
def test_a_change_that_is_not_allowed_is_refused_by_name(name, value, words):
    with pytest.raises(InvalidGainError, match=f"'{name}'.*{words}") as caught:
        Tunables(SCHEMA, CURRENT).checked({name: value})

    (error,) = caught.value.details["errors"]
    assert error["field"] == name


def test_all_problems_are_listed():
    with pytest.raises(InvalidGainError, match="1 more") as caught:
        Tunables(SCHEMA, CURRENT).checked({"p": -1.0, "q": 0.0, "d": 0.5})

    assert [e["field"] for e in caught.value.details["errors"]] == ["p", "q"]
    assert CURRENT == {"p": 10.0, "d": 0.0}


def test_names_of_schema_and_values_must_agree():
    with pytest.raises(ValueError, match="Give one value for each name"):
        Tunables(SCHEMA, {"p": 1.0})


def test_values_that_do_not_fit_together_are_refused():
    def refuse(values):
        raise InvalidGainError(f"{values} do not fit together.", remedy="Change one.")

    tunables = Tunables(SCHEMA, CURRENT, check=refuse)

    with pytest.raises(InvalidGainError, match="do not fit together"):
        tunables.checked({"p": 20.0})
    assert tunables.values == CURRENT


def test_applied_values_replace_the_mapping_that_readers_hold():
    applied = []
    tunables = Tunables(SCHEMA, CURRENT, apply=applied.append)
    before = tunables.values

    tunables.apply(tunables.checked({"p": 20.0}))

    assert before == CURRENT
    assert tunables.values == {"p": 20.0, "d": 0.0}
    assert applied == [tunables.values]


def test_joined_tunables_are_checked_and_applied_by_their_parts():
    def refuse_large(values):
        if values["p"] > 50.0:
            raise InvalidGainError("p is too large for d.", remedy="Lower p.")

    pid = Tunables(SCHEMA, CURRENT, check=refuse_large)
    speed = Tunables({"speed": Tunable("", 0.0, 1.0)}, {"speed": 1.0})
    both = Tunables.joined(pid, speed)

    with pytest.raises(InvalidGainError, match="too large"):
        both.checked({"p": 60.0})
    both.apply(both.checked({"speed": 0.5, "d": 0.1}))

    assert both.values == {"p": 10.0, "d": 0.1, "speed": 0.5}
    assert pid.values == {"p": 10.0, "d": 0.1}
    assert speed.values == {"speed": 0.5}
