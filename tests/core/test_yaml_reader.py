"""YAML is read as ROS reads it, without the traps of YAML 1.1.

Angles are written as rosparam understands them, and nothing else runs.
"""

import math

import pytest

from station.core.errors import ConfigError
from station.core.yaml_reader import parse_angle, parse_value, parse_yaml, read_yaml


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("600", 600),
        ("-3", -3),
        ("0x1F", 31),
        ("0o17", 15),
        ("1.5", 1.5),
        (".5", 0.5),
        ("5.", 5.0),
        ("1e-3", 0.001),
        ("1E5", 1e5),
        ("-2.5e+3", -2500.0),
        (".inf", math.inf),
        ("-.INF", -math.inf),
        ("true", True),
        ("Off", False),
        ("yes", True),
        ("", None),
        ("~", None),
        ("null", None),
        ("panda", "panda"),
        ("2024-01-01", "2024-01-01"),
        ("172.16.0.2", "172.16.0.2"),
        ("'600'", "600"),
        ('"true"', "true"),
        ("!!str 600", "600"),
        ("deg(90)", math.pi / 2),
        ("!degrees 90", math.pi / 2),
        ("!radians pi/2", math.pi / 2),
        ("[1, 2.0, a]", [1, 2.0, "a"]),
    ],
)
def test_scalar_is_what_it_looks_like(text, value):
    read = parse_value(text, "test")

    assert read == value
    assert type(read) is type(value)


def test_not_a_number_is_read_as_such():
    assert math.isnan(parse_value(".nan", "test"))


@pytest.mark.parametrize("text", ["010", "1:30", "1_000", "-007"])
def test_scalar_with_two_meanings_is_refused(text):
    with pytest.raises(ConfigError, match=r"f\.yaml:1:4: .*1\.1 and 1\.2"):
        parse_yaml(f"a: {text}", "f.yaml")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a: 1\nb: 2\na: 3", r"f\.yaml:3:1: The text has the key 'a' twice"),
        ("a: {b: 1, b: 2}", r"f\.yaml:1:11: a has the key 'b' twice"),
        ("on: 1", r"f\.yaml:1:1: The text has the key 'on', which is not text"),
        ("1: 1", r"f\.yaml:1:1: The text has the key '1', which is not text"),
        ("[a]: 1", r"f\.yaml:1:1: The text has the key \(a list or mapping\)"),
        ("a: [1, 2", r"f\.yaml:2:1: The text is not valid YAML"),
        ("a: 1\n\tb: 2", r"f\.yaml:2:1: The text is not valid YAML"),
        ("a: 1\n---\nb: 2", r"f\.yaml:2:1: The text is not valid YAML"),
        ("a: *nothing", r"f\.yaml:1:4: The text is not valid YAML"),
        ("a: &x [*x]", r"f\.yaml:1:4: a\[0\] is an alias that contains itself"),
        ("a: !!python/name:os.system", r"f\.yaml:1:4: .* is unknown"),
        ("a: !!python/object/apply:os.getcwd []", r"f\.yaml:1:4: a has the tag .* unk"),
        ("a: !!float x", r"f\.yaml:1:4: a is 'x', which is not a number"),
        ("<<: 1", r"f\.yaml:1:5: The text merges 1 with `<<`, which takes a mapping"),
        ("- a", r"f\.yaml:1:1: .*must hold a mapping"),
    ],
)
def test_refusal_says_where_and_why(text, message):
    with pytest.raises(ConfigError, match=message):
        parse_yaml(text, "f.yaml")


def test_aliases_and_merges_are_followed():
    text = "base: &b {p: 600, d: 30}\narm: {<<: *b, d: 10}\nleg: {<<: [*b, {x: 1}]}"

    values = parse_yaml(text, "f.yaml").values

    assert values["arm"] == {"p": 600, "d": 10}
    assert values["leg"] == {"p": 600, "d": 30, "x": 1}


def test_position_of_every_value_is_known():
    document = parse_yaml("a: 1\nb:\n  c: [x, y]\n", "f.yaml")

    assert document.where(("b", "c", 1)) == "f.yaml:3:10"
    assert document.where(("b", "missing")) == "f.yaml:3:3"
    assert document.where(("missing",)) == "f.yaml:1:1"


def test_empty_file_is_an_empty_mapping(tmp_path):
    (tmp_path / "f.yaml").write_text("# nothing\n")

    assert read_yaml(tmp_path / "f.yaml").values == {}


def test_unreadable_files_are_refused(tmp_path):
    (tmp_path / "latin.yaml").write_bytes(b"a: \xe4")

    with pytest.raises(ConfigError, match="No such file"):
        read_yaml(tmp_path / "missing.yaml")
    with pytest.raises(ConfigError, match="not UTF-8"):
        read_yaml(tmp_path / "latin.yaml")
    with pytest.raises(ConfigError, match="cannot be read"):
        read_yaml(tmp_path)


@pytest.mark.parametrize("depth", [100, 20_000])
def test_endless_nesting_is_refused(depth):
    with pytest.raises(ConfigError, match="nested deeper than 64 levels"):
        parse_yaml("x: " + "[" * depth + "]" * depth, "deep.yaml")


def test_aliases_that_explode_are_refused_at_once():
    nine = [f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 9)}]" for i in range(1, 12)]
    lines = ["a0: &a0 [1]", *nine]
    with pytest.raises(ConfigError, match="more than 100000 values"):
        parse_yaml("\n".join(lines), "laughs.yaml")


def test_a_long_list_in_place_of_a_mapping_is_shown_in_part():
    with pytest.raises(ConfigError, match="must hold a mapping") as caught:
        parse_yaml("- some text\n" * 1000, "list.yaml")
    assert len(caught.value.message) < 300


@pytest.mark.parametrize(
    ("text", "count"),
    [
        ("1" * 10_000, 10_000),
        (f"0x{'f' * 9_998}", 10_000),
        (f"{'1' * 9_000}.5e3", 9_004),
        (f"!degrees {'1' * 5_000}", 5_000),
        (f"rad({'(' * 5_000})", 5_005),
        (f"!!int {'x' * 5_000}", 5_000),
    ],
)
def test_number_that_is_too_long_is_refused_in_few_words(text, count):
    with pytest.raises(ConfigError) as caught:
        parse_yaml(f"a: [0, {text}]", "f.yaml")

    message = caught.value.message
    assert message.startswith("f.yaml:1:8: a[1] is ")
    assert message.endswith(f"a number of {count} characters; allowed are 100.")
    assert len(message) < 200


@pytest.mark.parametrize("text", [f"0{'1' * 9_000}", f"!unknown {'x' * 9_000}"])
def test_long_scalar_that_is_refused_is_shown_in_part(text):
    with pytest.raises(ConfigError) as caught:
        parse_yaml(f"a: {text}", "f.yaml")

    assert len(caught.value.message) < 250


def test_number_beyond_all_floats_is_refused_and_infinity_is_not():
    with pytest.raises(ConfigError, match=r"a\.b is 1e999, which is too large"):
        parse_yaml("a: {b: 1e999}", "f.yaml")

    assert parse_value(".inf", "f.yaml") == math.inf


@pytest.mark.parametrize(
    ("text", "angle"),
    [
        ("rad(pi/2)", math.pi / 2),
        ("rad(2*pi)", 2 * math.pi),
        ("deg(90)", math.pi / 2),
        ("deg(-45.5)", math.radians(-45.5)),
        ("-pi", -math.pi),
        ("rad(1 + (2 - 3) / 4)", 0.75),
    ],
)
def test_angle_is_computed(text, angle):
    assert parse_angle(text) == pytest.approx(angle, rel=1e-15)


@pytest.mark.parametrize(
    "text",
    [
        "rad()",
        "rad(1/0)",
        "deg(x)",
        "rad(True)",
        "rad(__import__('os'))",
        "rad(2**3)",
        "rad((1)",
        f"rad({'1+' * 60}1)",
    ],
)
def test_everything_else_is_refused(text):
    with pytest.raises(ValueError, match=r"arithmetic|neither|an angle may have 100"):
        parse_angle(text)
