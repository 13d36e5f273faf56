"""Wire models of controllers: states, types, goals, gains and parameters."""

import json

import pytest
from pydantic import TypeAdapter, ValidationError

from station.controllers import CONTROLLERS
from station.core.control.controller_factory import ControllerFactory
from station.core.control.controller_loader import TableLoader
from station.core.parameters import Parameters
from station.hw.mock import MockRobotHW
from station.reports import examples_of
from station.wire import (
    CommandRequest,
    ControllerType,
    Gains,
    GainSetRequest,
    GainsPatch,
    Goal,
    GoalRequest,
    LoadRequest,
    ParameterRequest,
    SwitchRequest,
    SwitchResult,
    TrajectoryRequest,
    Tunable,
)
from station.wire.base import FileName


@pytest.mark.parametrize(
    "kind",
    [
        LoadRequest,
        SwitchRequest,
        SwitchResult,
        GainsPatch,
        CommandRequest,
        GoalRequest,
        TrajectoryRequest,
    ],
)
def test_examples_are_valid(kind):
    for example in examples_of(kind.__doc__):
        assert kind.model_validate(example)


def test_the_schema_of_gains_is_called_schema_on_the_wire():
    gains = Gains(values={"p": 1.0}, schema={"p": Tunable()}, revision=1, etag='"x"')

    text = gains.model_dump_json(by_alias=True)
    assert '"schema":' in text
    assert Gains.model_validate_json(text) == gains


def test_a_switch_must_name_something():
    with pytest.raises(ValidationError, match="at least one controller"):
        SwitchRequest()


def test_a_switch_is_strict_unless_asked_otherwise():
    assert SwitchRequest(start=["a"]).strictness == "strict"


@pytest.mark.parametrize("timeout", [-0.1, 60.1])
def test_a_switch_does_not_wait_for_ever(timeout):
    with pytest.raises(ValidationError):
        SwitchRequest(start=["a"], timeout=timeout)


@pytest.fixture(scope="module")
def types():
    factory = ControllerFactory(MockRobotHW(), Parameters(), [TableLoader(CONTROLLERS)])
    models = [ControllerType.model_validate(one) for one in factory.describe_types()]
    # As a client reads them.
    return {
        one.type: ControllerType.model_validate_json(one.model_dump_json())
        for one in models
    }


def parameter(types, kind, name):
    (found,) = [one for one in types[kind].parameters if one.name == name]
    return found


def test_every_type_can_be_imported_and_says_what_it_does(types):
    assert list(types) == list(CONTROLLERS)
    for one in types.values():
        assert one.error == ""
        assert one.description.endswith((".", ":"))


def test_every_parameter_is_described(types):
    for one in types.values():
        names = [each.name for each in one.parameters]
        assert len(set(names)) == len(names), one.type
        for each in one.parameters:
            assert each.description, each.name
            assert not (each.required and each.default is not None)


def test_a_group_names_its_joints_and_the_units_of_its_gains(types):
    kind = "effort_controllers/JointGroupPositionController"
    joints = parameter(types, kind, "joints")
    assert (joints.type, joints.required, joints.names) == ("strings", True, "joint")
    gain = parameter(types, kind, "<joint>/pid/d")
    assert (gain.unit, gain.default, gain.required) == ("Nm s/rad", 0.0, False)
    assert parameter(types, kind, "<joint>/pid/i_clamp_max").default_text == "i_clamp"


def test_bounds_and_choices_are_told(types):
    kind = "franka_controllers/CartesianJogController"
    timeout = parameter(types, kind, "command_timeout")
    assert (timeout.minimum, timeout.excludes_minimum, timeout.maximum) == (0, True, 1)
    assert parameter(types, kind, "frame").choices == ["O", "EE"]
    bounds = parameter(types, kind, "max_joint_acceleration")
    assert bounds.default == [7.0, 5.0, 7.0, 7.0, 7.0, 7.0, 7.0]


def test_an_absent_bound_is_null(types):
    text = types["joint_state_controller/JointStateController"].model_dump_json()
    (rate,) = [
        one for one in json.loads(text)["parameters"] if one["name"] == "publish_rate"
    ]
    assert (rate["minimum"], rate["maximum"], rate["unit"]) == (None, None, "Hz")


def test_a_goal_under_way_has_no_result():
    text = (
        '{"id": "1", "status": "active", "progress": 0.5, "cancel_requested": false, '
        '"result": null}'
    )

    assert Goal.model_validate_json(text).result is None


@pytest.mark.parametrize("value", [1, 0.5, "x", True, None, [1, [2]], {"a": {"b": 1}}])
def test_a_value_is_any_json(value):
    assert ParameterRequest.model_validate({"value": value}).value == value


def test_a_value_that_is_nested_too_deep_is_refused():
    value = 1
    for _ in range(40):
        value = [value]
    with pytest.raises(ValidationError, match="nested deeper"):
        ParameterRequest.model_validate({"value": value})


def test_no_controllers_are_not_the_same_as_all():
    assert GainSetRequest().controllers is None
    with pytest.raises(ValidationError):
        GainSetRequest(controllers=[])


@pytest.mark.parametrize("name", ["", ".", "-a", "a/b", "a b", "x" * 101])
def test_names_are_segments_of_a_path(name):
    with pytest.raises(ValidationError):
        TypeAdapter(FileName).validate_python(name)
