"""A tree of parameters that is typed where it is read."""

import pytest

from station.core.errors import ParameterError
from station.core.parameters import Parameters, ParameterTree, unknown_parameters


@pytest.fixture
def tree():
    return ParameterTree({"arm": {"p": 600, "joints": ["a", "b"]}, "rate": 1000})


def test_values_are_found_by_their_path(tree):
    assert tree.get("arm/p") == 600
    assert tree.get("/arm//p/") == 600
    assert tree.get("") == {"arm": {"p": 600, "joints": ["a", "b"]}, "rate": 1000}


@pytest.mark.parametrize("path", ["nope", "arm/nope", "rate/too/deep"])
def test_what_is_not_there_gives_the_default(tree, path):
    assert tree.get(path) is None
    assert tree.get(path, 3) == 3


def test_what_goes_in_and_comes_out_is_a_copy(tree):
    value = {"d": [1.0]}
    tree.set("new", value)
    value["d"].append(2.0)

    tree.get("new")["d"].append(3.0)

    assert tree.get("new") == {"d": [1.0]}


def test_namespaces_are_made_on_the_way(tree):
    tree.set("a/b/c", 1)
    tree.set("rate/hz", 5)

    assert tree.get("a") == {"b": {"c": 1}}
    assert tree.get("rate") == {"hz": 5}


def test_keys_with_slashes_are_paths():
    assert ParameterTree({"panda_joint1/pid": {"p": 1}}).get("panda_joint1/pid/p") == 1


def test_the_root_must_be_a_mapping(tree):
    with pytest.raises(ParameterError, match="mapping"):
        tree.set("", 3)

    tree.set("", {"x": 1})
    assert tree.get("") == {"x": 1}


def test_deleting_says_whether_there_was_anything(tree):
    assert tree.delete("arm/p")
    assert not tree.delete("arm/p")
    assert not tree.delete("nope/deep")
    assert not tree.delete("")
    assert tree.get("arm") == {"joints": ["a", "b"]}


def test_changes_are_told(tree):
    changes = []
    unsubscribe = tree.subscribe(lambda path, value: changes.append((path, value)))

    tree.set("arm/p", 1)
    tree.delete("/arm/p")
    tree.delete("arm/p")
    unsubscribe()
    tree.set("arm/p", 2)

    assert changes == [("arm/p", 1), ("arm/p", None)]


def test_a_namespace_sees_its_part_of_the_tree(tree):
    arm = Parameters(tree).namespace("arm")

    arm.set("i", 2)

    assert arm.get("p") == 600
    assert arm.has("i")
    assert not arm.has("rate")
    assert tree.get("arm/i") == 2
    assert arm.resolve("pid/p") == "arm/pid/p"
    assert sorted(arm.keys()) == ["i", "joints", "p"]
    assert arm.namespace("p").keys() == []


TYPED = {
    "float": 1.5,
    "int": 2,
    "bool": True,
    "str": "x",
    "str_list": ["a"],
    "float_list": [1, 2.5],
    "nan": float("nan"),
    "inf_list": [1.0, float("inf")],
}


@pytest.mark.parametrize(
    ("method", "key", "value"),
    [
        ("get_float", "float", 1.5),
        ("get_float", "int", 2.0),
        ("get_int", "int", 2),
        ("get_bool", "bool", True),
        ("get_str", "str", "x"),
        ("get_str_list", "str_list", ["a"]),
        ("get_float_list", "float_list", [1.0, 2.5]),
    ],
)
def test_values_are_read_with_their_type(method, key, value):
    read = getattr(Parameters(ParameterTree(TYPED)), method)(key)

    assert read == value
    assert type(read) is type(value)


@pytest.mark.parametrize(
    ("method", "keys"),
    [
        ("get_float", ["bool", "str", "float_list", "nan", "missing"]),
        ("get_int", ["bool", "float", "str", "missing"]),
        ("get_bool", ["int", "str", "missing"]),
        ("get_str", ["int", "str_list", "missing"]),
        ("get_str_list", ["str", "float_list", "missing"]),
        ("get_float_list", ["str_list", "float", "inf_list", "missing"]),
    ],
)
def test_a_wrong_type_is_refused_with_the_full_path(method, keys):
    params = Parameters(ParameterTree({"arm": TYPED}), "arm")

    for key in keys:
        with pytest.raises(ParameterError, match=f"'arm/{key}'") as caught:
            getattr(params, method)(key)
        assert caught.value.details == {"parameter": f"arm/{key}"}


def test_what_nobody_read_or_knows_is_found_with_the_nearest_name():
    reads = set()
    tree = ParameterTree({
        "arm": {
            "joint": "j",
            "constrains": {"goal_time": 1.0, "j": {"goal": 0.1}},
            "constraints": {"goal_time": 1.0, "j": {"gaol": 0.1}},
            "whole": {"any": {"key": 1}},
            "empty": {},
        },
        "joint": "of somebody else",
    })
    arm = Parameters(tree, "arm", reads)
    constraints = arm.namespace("constraints")
    assert arm.get_str("joint") == "j"
    assert constraints.get_float("goal_time", 0.0) == 1.0
    assert constraints.namespace("j").get_float("goal", 0.5) == 0.5
    assert arm.get("whole") == {"any": {"key": 1}}
    assert arm.has("empty")  # to ask is not to read

    found = dict(unknown_parameters(arm, reads))

    assert list(found) == ["constrains", "constraints/j/gaol", "empty"]
    assert found["constrains"].startswith("Did you mean 'constraints'?")
    assert "goal" in found["constraints/j/gaol"]
    assert unknown_parameters(arm, reads | {"arm"}) == []
    assert unknown_parameters(Parameters(tree, "nothing"), reads) == []


@pytest.mark.parametrize(
    "gains",
    [
        {"arm/j": {"pid": {"p": 1.0}}},
        {"arm/j/pid": {"p": 1.0}},
        {"arm": {"j/pid": {"p": 1.0}}},
        {"arm": {"j": {"pid": {"p": 1.0}}}},
        {"arm": {"k": {"p": 2.0}}, "arm/j": {"pid": {"p": 1.0}}},
    ],
)
def test_a_key_with_a_slash_is_found_by_its_path(gains):
    """Joints of ROS robots have names such as `arm/j`."""
    params = Parameters(ParameterTree({"gains": gains}), "gains/arm/j")
    params.set("pid/i", 3.0)
    params.set("pid/p", 4.0)

    assert params.get("pid") == {"p": 4.0, "i": 3.0}
    assert params.tree.delete("gains/arm/j/pid/p")
    assert not params.has("pid/p")
    assert not params.tree.delete("gains/arm/j/pid/p")
    assert Parameters(params.tree, "gains").keys() == list(gains)


def test_a_list_may_need_a_length():
    params = Parameters(ParameterTree(TYPED))

    assert params.get_float_list("float_list", 2) == [1.0, 2.5]
    with pytest.raises(ParameterError, match="3 numbers"):
        params.get_float_list("float_list", 3)


@pytest.mark.parametrize(
    ("method", "default"),
    [
        ("get_float", 0.5),
        ("get_int", 0),
        ("get_bool", False),
        ("get_str", ""),
        ("get_str_list", []),
    ],
)
def test_defaults_are_for_what_is_missing(method, default):
    assert getattr(Parameters(), method)("missing", default) == default
