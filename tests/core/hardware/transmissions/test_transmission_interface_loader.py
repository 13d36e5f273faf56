"""Robot descriptions become transmissions, joints and maps as recorded."""

import gzip
import json
from functools import partial
from pathlib import Path

import pytest

from station.core.errors import StationError
from station.core.hardware import transmissions as transmission_interfaces
from station.core.hardware.interfaces import (
    JointStateInterface,
    joint as actuator_interfaces,
    joint as joint_interfaces,
)
from station.core.hardware.interfaces.joint import (
    ActuatorHandle,
    ActuatorStateHandle,
    ActuatorStateInterface,
)
from station.core.hardware.robot_hw import RobotHW
from station.core.hardware.transmissions import (
    RobotTransmissions,
    SimpleTransmission,
    TransmissionInterfaceError,
    TransmissionInterfaceLoader,
    TransmissionParser,
)
from station.core.hardware.transmissions.transmission_interface_loader import (
    HARDWARE_INTERFACES,
    interface_of,
)

VECTORS = Path(__file__).parents[3] / "data" / "vectors" / "transmission_urdf.json.gz"
ACTUATORS = ("foo_actuator", "bar_actuator", "baz_actuator")
QUANTITIES = ("position", "velocity", "effort")
STATES = "joint_state_after_propagate(act pos=50,vel=-50,eff=1)"
COMMANDS = "actuator_cmds_after_propagate(joint cmd 1.0,1.5,2.0.. by name order)"
SIMPLE_JOINT = (
    '<joint name="{}"><hardwareInterface>hardware_interface/{}'
    "</hardwareInterface></joint>"
)


@pytest.fixture(scope="module")
def files():
    with gzip.open(VECTORS, "rt") as file:
        return json.load(file)["files"]


class Rig:
    """A robot with three actuators, as the recorded one."""

    def __init__(self, *, transmission_types=None, encoders=False):
        self.hw = RobotHW()
        self.transmissions = RobotTransmissions()
        self.commands = {quantity: [0.0] * 3 for quantity in QUANTITIES}
        state = ActuatorStateInterface()
        sensor = [7.0] * 3 if encoders else None
        for index, name in enumerate(ACTUATORS):
            values = ([50.0] * 3, [-50.0] * 3, [1.0] * 3)
            handle = ActuatorStateHandle(
                name, *values, index, absolute_position=sensor, torque_sensor=sensor
            )
            state.register_handle(handle)
        self.hw.register_interface(state)
        for quantity in QUANTITIES:
            type_name = f"{quantity.title()}ActuatorInterface"
            interface = getattr(actuator_interfaces, type_name)()
            for handle in state.handles():
                command = self.commands[quantity]
                interface.register_handle(ActuatorHandle(handle, command))
            self.hw.register_interface(interface)
        self.loader = TransmissionInterfaceLoader(
            self.hw, self.transmissions, transmission_types
        )

    def joints(self, type_name):
        """Return a joint interface of the robot, or None."""
        return self.hw.get(getattr(joint_interfaces, type_name))

    def maps(self, type_name):
        """Return a transmission interface, or None."""
        return self.transmissions.get(getattr(transmission_interfaces, type_name))


def same(number, recorded):
    return repr(float(number)) == repr(float(recorded))


def check_loaded(rig, recorded):
    assert len(rig.loader.loaded) == recorded["n_transmission_data"]
    assert sorted(rig.loader.raw_joint_data.names) == recorded["raw_joint_data"]
    for type_name, names in recorded["joint_interfaces"].items():
        assert rig.joints(type_name).get_names() == names
    for type_name, names in recorded["transmission_interfaces"].items():
        assert rig.maps(type_name).get_names() == names


def check_propagated(rig, recorded):
    rig.maps("ActuatorToJointStateInterface").propagate()
    for name, state in recorded[STATES].items():
        joint = rig.joints("JointStateInterface").get_handle(name)
        for quantity in QUANTITIES:
            assert same(getattr(joint, f"get_{quantity}")(), state[quantity])
    for quantity in QUANTITIES:
        interface = rig.joints(f"{quantity.title()}JointInterface")
        if interface is not None:
            for number, name in enumerate(interface.get_names()):
                interface.get_handle(name).set_command(1.0 + 0.5 * number)
            rig.maps(f"JointToActuator{quantity.title()}Interface").propagate()
    for name, commands in recorded[COMMANDS].items():
        for quantity in QUANTITIES:
            given = rig.commands[quantity][ACTUATORS.index(name)]
            assert same(given, commands[f"{quantity}_cmd"])


def check_load(load, rig, recorded):
    if recorded["accepted"]:
        load()
        check_loaded(rig, recorded)
        check_propagated(rig, recorded)
        return
    with pytest.raises(StationError) as caught:
        load()
    for line in recorded["log"]:
        if line.startswith("[ERROR] "):
            assert line.removeprefix("[ERROR] ") in caught.value.message


def test_descriptions_are_loaded_as_recorded(files):
    for file in files:
        if "interface_load_urdf" in file:
            rig = Rig()
            recorded = file["interface_load_urdf"]
            load = partial(rig.loader.load_urdf, file["urdf"])
            check_load(load, rig, recorded)


def test_single_transmissions_are_loaded_as_recorded(files):
    for file in files:
        if file["parse_result"] is not True:
            continue
        infos = TransmissionParser().parse(file["urdf"])
        for info, recorded in zip(infos, file["transmissions"], strict=True):
            rig = Rig()
            load = partial(rig.loader.load, info)
            check_load(load, rig, recorded["interface_load_single"])


def describe(kind, joints, actuators):
    return (
        f'<robot name="r"><transmission name="t"><type>{kind}</type>'
        f"{joints}{actuators}</transmission></robot>"
    )


def describe_differential(interface, *, roles=("joint1", "joint2"), extra=""):
    joints = "".join(
        f'<joint name="{name}"><role>{role}</role><mechanicalReduction>2'
        f"</mechanicalReduction><offset>0.5</offset>{extra}<hardwareInterface>"
        f"hardware_interface/{interface}</hardwareInterface></joint>"
        for name, role in zip(("roll", "pitch"), roles, strict=True)
    )
    actuators = "".join(
        f'<actuator name="{name}_actuator"><role>{role}</role><mechanicalReduction>'
        f"{reduction}</mechanicalReduction></actuator>"
        for name, role, reduction in (("foo", "actuator2", 5), ("bar", "actuator1", 4))
    )
    kind = "transmission_interface/DifferentialTransmission"
    return describe(kind, joints, actuators)


@pytest.mark.parametrize("quantity", ["Position", "Velocity", "Effort"])
def test_bidirectional_interface_maps_commands_and_states_both_ways(quantity):
    rig = Rig()
    rig.loader.load_urdf(
        describe_differential(f"BiDirectional{quantity}JointInterface")
    )
    for type_name in (
        "ActuatorToJointStateInterface",
        "JointToActuatorStateInterface",
        f"JointToActuator{quantity}Interface",
        f"ActuatorToJoint{quantity}Interface",
    ):
        assert rig.maps(type_name).get_names() == ["t"]
    joints = rig.joints(f"{quantity}JointInterface")
    for name in ("roll", "pitch"):
        joints.get_handle(name).set_command(3.0)
    rig.maps(f"JointToActuator{quantity}Interface").propagate()
    for name in ("roll", "pitch"):
        joints.get_handle(name).set_command(0.0)
    rig.maps(f"ActuatorToJoint{quantity}Interface").propagate()
    commands = [joints.get_handle(name).get_command() for name in ("roll", "pitch")]
    assert commands == pytest.approx([3.0, 3.0], rel=1e-12)  # rounding of one trip


@pytest.mark.parametrize("encoders", [False, True])
def test_joint_has_the_sensors_that_all_its_actuators_have(encoders):
    rig = Rig(encoders=encoders)
    rig.loader.load_urdf(describe_differential("EffortJointInterface"))
    joint = rig.joints("JointStateInterface").get_handle("roll")
    assert joint.has_absolute_position() is encoders
    assert joint.has_torque_sensor() is encoders
    if encoders:
        rig.maps("ActuatorToJointStateInterface").propagate()
        expected = (7.0 / 4.0 + 7.0 / 5.0) / 4.0 + 0.5
        assert joint.get_absolute_position() == expected


OWN_TYPES = {"own/Belt": lambda _: SimpleTransmission(5.0)}
SIMPLE = describe(
    "own/Belt",
    SIMPLE_JOINT.format("foo_joint", "EffortJointInterface"),
    '<actuator name="foo_actuator"/>',
)


def test_own_transmission_type_is_used():
    rig = Rig(transmission_types=OWN_TYPES)
    rig.loader.load_urdf(SIMPLE)
    assert rig.loader.loaded[0].transmission.reduction == 5.0


def test_robot_without_the_actuator_interface_is_refused():
    loader = TransmissionInterfaceLoader(RobotHW(), RobotTransmissions(), OWN_TYPES)
    with pytest.raises(
        TransmissionInterfaceError,
        match="does not have the required hardware interface "
        "'hardware_interface::ActuatorStateInterface'",
    ):
        loader.load_urdf(SIMPLE)


def test_joint_of_the_robot_itself_is_not_taken_over():
    rig = Rig(transmission_types=OWN_TYPES)
    own = joint_interfaces.JointStateInterface()
    own.register_handle(
        joint_interfaces.JointStateHandle("foo_joint", [0.0], [0.0], [0.0])
    )
    rig.hw.register_interface(own)
    with pytest.raises(TransmissionInterfaceError, match="already has a state"):
        rig.loader.load_urdf(SIMPLE)


@pytest.mark.parametrize("quantity", ["position", "velocity", "effort"])
@pytest.mark.parametrize("prefix", ["", "BiDirectional"])
def test_joint_and_actuator_interface_have_the_same_quantity(quantity, prefix):
    name = f"hardware_interface/{prefix}{quantity.title()}JointInterface"
    kind, is_bidirectional = HARDWARE_INTERFACES[name]
    assert is_bidirectional is bool(prefix)
    assert kind.quantity == quantity
    assert kind.joint_interface.__name__ == f"{quantity.title()}JointInterface"
    assert kind.actuator_interface.__name__ == f"{quantity.title()}ActuatorInterface"


def test_state_alone_has_no_command():
    kind = HARDWARE_INTERFACES["hardware_interface/JointStateInterface"]
    assert kind == (None, False)


def test_interface_is_made_once():
    robot = RobotHW()
    first = interface_of(robot, JointStateInterface)
    assert interface_of(robot, JointStateInterface) is first
    assert robot.get(JointStateInterface) is first
