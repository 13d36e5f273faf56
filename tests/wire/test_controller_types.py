"""Every type of the station says over REST which parameters it has."""

import json

import pytest

from station.controllers import CONTROLLERS
from station.core.control.controller_factory import ControllerFactory
from station.core.control.controller_loader import TableLoader
from station.core.parameters import Parameters
from station.hw.mock import MockRobotHW
from station.wire import ControllerType


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
