"""Parameters go into a YAML file and come back the same."""

import math

import pytest
import yaml
from hypothesis import given, settings, strategies as st

from station.config.parameters_yaml import (
    dump_parameters,
    load_parameters,
    load_parameters_text,
)
from station.core.config_error import ConfigError
from station.core.parameters import Parameters

TEXT = """
arm:
  type: effort_controllers/JointGroupPositionController
  joints: [a, b]
  a: {pid: {p: 600, i: 0.0, d: 1e-3}}
"""
SCALARS = st.one_of(
    st.booleans(),
    st.integers(-(2**40), 2**40),
    st.floats(allow_nan=False),
    st.text(st.characters(categories=["L", "N", "P", "Zs"])),
)
NAMES = st.from_regex(r"[a-z_][a-z0-9_]{0,8}", fullmatch=True)
TREES = st.dictionaries(
    NAMES,
    st.recursive(
        st.one_of(SCALARS, st.lists(SCALARS, max_size=3)),
        lambda values: st.dictionaries(NAMES, values, min_size=1, max_size=3),
        max_leaves=8,
    ),
    max_size=4,
)


def parameters(values):
    params = Parameters()
    params.set("", values)
    return params


def test_a_file_is_loaded_into_its_namespace(tmp_path):
    file = tmp_path / "controllers.yaml"
    file.write_text(TEXT)
    params = Parameters()

    load_parameters(params.namespace("panda"), file)

    assert params.get_float("panda/arm/a/pid/d") == 0.001
    assert params.get_str_list("panda/arm/joints") == ["a", "b"]


def test_loading_merges_and_tells_what_changed():
    params = parameters({"arm": {"rate": 50, "a": {"pid": {"p": 1}}}})
    changes = []
    params.tree.subscribe(lambda path, value: changes.append((path, value)))

    load_parameters_text(params, "arm: {a: {pid: {p: 2, i: 3}}}", "text")

    assert params.get("arm") == {"rate": 50, "a": {"pid": {"p": 2, "i": 3}}}
    assert changes == [("arm/a/pid/p", 2), ("arm/a/pid/i", 3)]


def test_a_file_that_is_refused_changes_nothing():
    params = parameters({"a": 1})

    with pytest.raises(ConfigError, match="text:2"):
        load_parameters_text(params, "a: 2\n  b: 3\n", "text")

    assert params.get() == {"a": 1}


@settings(max_examples=50)
@given(TREES)
def test_what_was_dumped_is_loaded_the_same(values):
    loaded = Parameters()

    load_parameters_text(loaded, dump_parameters(parameters(values)), "text")

    assert loaded.get() == values


@pytest.mark.parametrize("number", [1e-3, 1e22, 5e-324, -1.5e300, 0.1])
def test_numbers_are_numbers_for_every_reader(number):
    text = dump_parameters(parameters({"x": number}))

    assert yaml.safe_load(text) == {"x": number}


def test_infinity_and_nan_can_be_written():
    text = dump_parameters(parameters({"x": math.inf, "y": math.nan}))

    assert text == "x: .inf\ny: .nan\n"


def test_an_empty_namespace_is_an_empty_mapping():
    assert dump_parameters(Parameters()) == "{}\n"
