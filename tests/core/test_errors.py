"""One root, builtin parents, and messages that reach the user as written."""

import difflib
import json

import pytest
from hypothesis import given, strategies as st

from station.core import errors
from station.core.errors import (
    ConfigError,
    counted,
    describe,
    key_text,
    printable,
    reason_of,
    show,
    suggest,
    trace_of_fault,
)
from tests.for_each import for_each

LEAVES = [
    value
    for value in vars(errors).values()
    if isinstance(value, type) and issubclass(value, errors.StationError)
]
# Its message is made of its problems.
WORDED = [leaf for leaf in LEAVES if leaf is not ConfigError]


@for_each(
    "error, builtin",
    [
        (errors.ResourceNotFoundError, KeyError),
        (errors.ParameterError, ValueError),
        (errors.ControllerNotFoundError, KeyError),
        (errors.ControllerTypeNotFoundError, KeyError),
        (errors.ControllerExistsError, ValueError),
        (errors.ControllerStateError, RuntimeError),
        (errors.SwitchTimeoutError, TimeoutError),
        (errors.InvalidCommandError, ValueError),
        (errors.InvalidGainError, ValueError),
        (errors.LoopError, RuntimeError),
        (errors.RobotDescriptionError, ValueError),
    ],
)
def test_leaves_are_caught_as_the_fitting_builtin(error, builtin):
    with pytest.raises(builtin):
        raise error("message")


def test_a_conflict_is_a_refused_switch():
    assert issubclass(errors.ResourceConflictError, errors.SwitchRefusedError)


@for_each("error", WORDED)
def test_the_message_is_shown_as_written(error):
    assert str(error("it's 'x'")) == "it's 'x'"


def test_every_leaf_has_a_code_of_its_own():
    codes = [leaf.code for leaf in LEAVES]

    assert len(set(codes)) == len(codes)


@for_each("error", LEAVES)
def test_the_tree_in_the_documentation_is_complete(error):
    assert error.__name__ in errors.__doc__


def test_details_are_a_copy():
    details = {"a": 1}

    error = errors.StationError("x", remedy="y", details=details)
    details["a"] = 2

    assert error.details == {"a": 1}
    assert error.remedy == "y"


@pytest.mark.parametrize(("number", "text"), [(0, "0 joints"), (1, "1 joint")])
def test_one_has_no_plural(number, text):
    assert counted(number, "joint") == text


def test_a_few_names_are_all_listed_and_the_likely_one_is_asked_for():
    assert suggest("x", []) == "There are none."
    assert suggest("x", ["arm"]) == "There are: arm."
    assert suggest("aarm", ["leg", "arm"]) == "Did you mean 'arm'? There are: leg, arm."


def test_of_many_names_the_nearest_three_are_told():
    names = [f"controller_{number}" for number in range(38)]

    told = suggest("controler_7", names)

    assert told.startswith("Did you mean 'controller_7', 'contr")
    assert told.endswith("? There are 38 in all.")
    assert told.count("'") == 6


@pytest.mark.parametrize("name", ["", "zzz", "nobody"])
def test_of_many_names_that_do_not_resemble_the_first_three_are_told(name):
    names = [f"arm_{number}_jit" for number in range(38)]

    told = suggest(name, names)

    assert told == "There are 38, such as 'arm_0_jit', 'arm_1_jit' and 'arm_2_jit'."


@given(st.text("abc_/", max_size=9), st.sets(st.text("abc_/", max_size=9), min_size=9))
def test_the_nearest_names_are_those_of_difflib(name, known):
    names = sorted(known)
    first, second, third = difflib.get_close_matches(name, names, 3, cutoff=0.0)
    is_likely = bool(difflib.get_close_matches(name, names, 1))
    resembles = bool(difflib.get_close_matches(name, names, 1, cutoff=0.3))

    told = suggest(name, names)

    if not resembles:
        assert told.startswith(f"There are {len(names)}, such as '{names[0]}', ")
        return
    assert told.startswith("Did you mean" if is_likely else "The nearest of")
    assert f"'{first}', '{second}' " in told
    assert f"'{third}'" in told


def test_all_problems_are_in_message_and_details():
    error = ConfigError(["a is 1.", "b is 2."], remedy="Correct it.")

    assert str(error) == "a is 1.\nb is 2."
    assert error.details == {"errors": ["a is 1.", "b is 2."]}
    assert error.remedy == "Correct it."
    assert isinstance(error, ValueError)


@pytest.mark.parametrize(
    ("value", "text"),
    [
        ("a", "'a'"),
        ("x" * 100, f"'{'x' * 78}…"),
        (1 << 16_609, "an integer of 16610 bits"),
        (-7, "-7"),
    ],
    ids=["text", "long text", "long integer", "integer"],
)
def test_long_values_are_shown_in_part(value, text):
    assert show(value) == text


@pytest.mark.parametrize(
    ("path", "text"),
    [(("robot", "arms", 0, "base"), "robot.arms[0].base"), ((0, "a"), "[0].a")],
)
def test_path_of_a_key_is_written_with_dots_and_indices(path, text):
    assert key_text(path) == text


class Unprintable(Exception):  # noqa: N818 - a plugin's own
    """Raises when it is to say what it is."""

    def __str__(self) -> str:
        raise RuntimeError("no words")


def test_a_reason_names_callback_type_and_text():
    assert reason_of("update", ValueError("no")) == "update raised ValueError: no"


def test_an_error_without_words_is_still_named():
    assert describe(Unprintable()) == "Unprintable: (its text cannot be read)"


def test_text_that_no_encoding_has_is_escaped():
    assert describe(OSError("file \udc80")) == "OSError: file \\udc80"
    assert json.dumps(printable("ü 漢 \ud800"), ensure_ascii=False).encode()


def test_a_traceback_can_be_encoded_and_says_where():
    try:
        raise ValueError("\udcff")
    except ValueError:
        trace = trace_of_fault()
    assert "test_errors.py" in trace
    assert trace.encode()


def test_endless_text_is_cut():
    assert len(describe(ValueError("x" * 10_000_000))) < 2000
    try:
        raise ValueError("x" * 10_000_000)
    except ValueError:
        assert len(trace_of_fault()) <= 20_000
