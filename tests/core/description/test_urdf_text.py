"""XML is read as the original's reader does, and refused with line and reason."""

from math import inf

import pytest

from station.core.description.urdf_text import (
    element_text,
    parse_decimal,
    parse_leading_number,
    parse_robot_description,
)
from station.core.errors import RobotDescriptionError


@pytest.mark.parametrize(
    "text", ["", "not xml", '<?xml version="1.0"?>', "<a><b", "<a>", "x" * 5_000_000]
)
def test_text_that_is_not_xml_is_refused_with_its_place(text):
    with pytest.raises(RobotDescriptionError, match=r"not XML: .*line 1"):
        parse_robot_description(text)


def test_namespaces_are_ignored():
    root = parse_robot_description('<robot xmlns="http://x"><link name="a"/></robot>')
    assert root.tag == "robot"
    assert root[0].tag == "link"


@pytest.mark.parametrize(
    ("content", "text"),
    [("  a \n b ", "a b"), ("", ""), ("<!-- c -->50", ""), ("50<!-- c -->", "50")],
)
def test_text_ends_at_the_first_child_also_a_comment(content, text):
    assert element_text(parse_robot_description(f"<a>{content}</a>")) == text


@pytest.mark.parametrize(
    ("text", "number"),
    [
        ("50", 50.0),
        ("-2.5e1abc", -25.0),
        (".5", 0.5),
        ("0x10", 16.0),
        ("-0x1p-1", -0.5),
        ("infinity", inf),
        ("0e5", 0.0),
        ("1e999", None),
        ("1e-999", None),
        ("abc", None),
        ("", None),
    ],
)
def test_leading_number_is_what_stod_finds(text, number):
    assert parse_leading_number(text) == number


def test_leading_nan_is_a_number():
    number = parse_leading_number("nan")
    assert number is not None
    assert number != number  # only NaN differs from itself


@pytest.mark.parametrize(
    ("text", "number"),
    [
        (" 1.5 ", 1.5),
        ("-1e3", -1000.0),
        ("50abc", None),
        ("1_0", None),
        ("nan", None),
        ("inf", None),
        ("1e999", None),
        ("", None),
    ],
)
def test_decimal_is_one_finite_number_and_nothing_else(text, number):
    assert parse_decimal(text) == number
