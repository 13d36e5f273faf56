"""A test over many cases runs all of them, and names those that fail."""

import pytest

from tests.for_each import for_each


def test_every_case_runs_and_all_that_fail_are_listed():
    seen = []

    @for_each("number, square", [(2, 4), (3, 6), (4, 16), (5, 0)])
    def check(number, square):
        seen.append(number)
        assert number * number == square

    with pytest.raises(AssertionError) as raised:
        check()

    assert seen == [2, 3, 4, 5]
    assert str(raised.value).startswith("2 of 4 cases:\n(3, 6): AssertionError: ")
    assert "\n(5, 0): AssertionError: " in str(raised.value)
    assert "(4, 16)" not in str(raised.value)


def test_cases_may_fail_by_any_exception():
    @for_each("case", ["a", "b"], ids=lambda case: f"case {case}")
    def check(case):
        if case == "a":
            raise KeyError(case)
        pytest.fail("for a reason")

    with pytest.raises(AssertionError) as raised:
        check()

    assert "case a: KeyError: 'a'" in str(raised.value)
    assert "case b: Failed: for a reason" in str(raised.value)


@for_each("part", "abc")
def test_fixtures_are_there_beside_the_cases(part, tmp_path):
    assert tmp_path.is_dir()
    assert part in "abc"


@pytest.mark.parametrize("cases", [[], list], ids=["none", "none when asked"])
def test_no_cases_are_a_mistake(cases):
    @for_each("name", cases)
    def check(name):
        pytest.fail(name)

    with pytest.raises(AssertionError, match="there is no case of name"):
        check()
