"""The state machine of controllers, and what the two bases claim (CM-1 … CM-20)."""

import pytest

from station.core.control.controller import (
    Controller,
    ControllerBase,
    ControllerSample,
    ControllerState,
    MultiInterfaceController,
    PackedSample,
)
from station.core.errors import ControllerLoadError, ResourceNotFoundError
from station.core.hardware.interfaces import (
    EffortJointInterface,
    JointStateInterface,
    PositionVelocityTorqueGainsJointInterface,
    VelocityJointInterface,
)
from station.core.hardware.robot_hw import RobotHW
from station.core.parameters import Parameters
from station.core.ports.set_point import SetPointElement, SetPointPort
from station.hw.mock import MockRobotHW
from station.memory.doubles import doubles

REQUESTS = {
    "start": ("starting", ControllerState.RUNNING),
    "stop": ("stopping", ControllerState.STOPPED),
    "wait": ("waiting", ControllerState.WAITING),
    "abort": ("aborting", ControllerState.ABORTED),
}
AFTER_INIT = [s for s in ControllerState if s is not ControllerState.CONSTRUCTED]


class Noting(ControllerBase):
    """Notes its callbacks with the state in which they run."""

    def __init__(self, state=ControllerState.CONSTRUCTED):
        super().__init__()
        self.state = state
        self.calls = []

    def starting(self, time):
        self.calls.append(("starting", self.state))

    def update(self, time, period):
        self.calls.append(("update", self.state))

    def stopping(self, time):
        self.calls.append(("stopping", self.state))

    def waiting(self, time):
        self.calls.append(("waiting", self.state))

    def aborting(self, time):
        self.calls.append(("aborting", self.state))


class Effort(Controller[EffortJointInterface]):
    """Claims the joints of its parameters."""

    def init(self, interface, params):
        for name in params.get_str_list("joints", []):
            interface.get_handle(name)


class Reading(Controller[JointStateInterface]):
    """Reads a joint."""

    hardware_interface = JointStateInterface

    def init(self, interface, params):
        interface.get_handle("joint1")


class Two(MultiInterfaceController):
    """Claims joint2 by velocity and joint1 by effort."""

    required_interfaces = (VelocityJointInterface, EffortJointInterface)
    optional_interfaces = (PositionVelocityTorqueGainsJointInterface,)

    def init(self, hw, params):
        hw.get(EffortJointInterface).get_handle("joint1")
        hw.get(VelocityJointInterface).get_handle("joint2")
        self.optional = hw.get(PositionVelocityTorqueGainsJointInterface)


@pytest.fixture
def robot():
    robot = MockRobotHW()
    robot.init(Parameters(), Parameters())
    return robot


def test_a_fresh_controller_is_in_no_listed_state():
    fresh = ControllerBase()

    assert fresh.state is ControllerState.CONSTRUCTED
    assert not any((
        fresh.is_initialized(),
        fresh.is_running(),
        fresh.is_stopped(),
        fresh.is_waiting(),
        fresh.is_aborted(),
    ))


@pytest.mark.parametrize("verb", REQUESTS)
def test_before_init_every_request_is_refused_without_a_callback(verb):
    controller = Noting()

    assert not getattr(controller, f"{verb}_request")(0.0)

    assert controller.calls == []
    assert controller.state is ControllerState.CONSTRUCTED


@pytest.mark.parametrize("before", AFTER_INIT)
@pytest.mark.parametrize("verb", REQUESTS)
def test_afterwards_every_request_works_and_can_be_repeated(verb, before):
    callback, after = REQUESTS[verb]
    controller = Noting(before)

    assert getattr(controller, f"{verb}_request")(0.0)
    assert getattr(controller, f"{verb}_request")(0.0)

    assert controller.calls == [(callback, before), (callback, after)]
    assert controller.state is after


@pytest.mark.parametrize("state", ControllerState)
def test_only_a_running_controller_is_updated(state):
    controller = Noting(state)

    controller.update_request(0.0, 0.01)

    assert bool(controller.calls) is (state is ControllerState.RUNNING)


def test_starting_voids_a_set_point_from_before():
    controller = Noting(ControllerState.STOPPED)
    controller.set_points = SetPointPort([SetPointElement("j", "rad")])
    controller.set_points.post([1.0])

    controller.start_request(0.0)

    assert controller.set_points.take() is None


def test_a_controller_that_declares_no_tunables_has_none():
    tunables = ControllerBase().tunables

    assert tunables.schema == {}
    assert tunables.values == {}
    assert tunables.checked({}) == {}


def test_what_every_controller_must_bring_is_demanded():
    with pytest.raises(NotImplementedError):
        ControllerBase().update(0.0, 0.01)


def test_claims_are_the_handles_asked_for(robot):
    controller = Effort()
    params = Parameters()
    params.set("joints", ["joint2", "joint1", "joint2"])

    (claim,) = controller.init_request(robot, params)

    assert claim.hardware_interface == EffortJointInterface.type_name
    assert claim.resources == ("joint1", "joint2")
    assert controller.is_initialized()
    assert robot.get(EffortJointInterface).get_claims() == []


def test_reading_claims_nothing_and_is_listed(robot):
    (claim,) = Reading().init_request(robot, Parameters())

    assert claim.hardware_interface == JointStateInterface.type_name
    assert claim.resources == ()


def test_several_interfaces_are_listed_in_the_order_of_the_class(robot):
    controller = Two()

    claims = controller.init_request(robot, Parameters())

    assert [(c.hardware_interface, c.resources) for c in claims] == [
        (VelocityJointInterface.type_name, ("joint2",)),
        (EffortJointInterface.type_name, ("joint1",)),
    ]
    assert controller.optional is None


def test_a_missing_required_interface_is_refused_by_name():
    with pytest.raises(ControllerLoadError, match="EffortJointInterface") as caught:
        Effort().init_request(RobotHW(), Parameters())

    assert "none" in caught.value.remedy


def test_initialising_twice_is_refused(robot):
    controller = Effort()
    controller.init_request(robot, Parameters())

    with pytest.raises(ControllerLoadError, match="not freshly constructed"):
        controller.init_request(robot, Parameters())


def test_a_failed_init_leaves_no_claims_and_no_state(robot):
    controller, params = Effort(), Parameters()
    params.set("joints", ["joint1", "nope"])

    with pytest.raises(ResourceNotFoundError):
        controller.init_request(robot, params)

    assert robot.get(EffortJointInterface).get_claims() == []
    assert controller.state is ControllerState.CONSTRUCTED


def test_a_derived_controller_may_claim_more(robot):
    class More(Two):
        """Claims joint1 by a third interface, too."""

        required_interfaces = (*Two.required_interfaces, JointStateInterface)

    claims = More().init_request(robot, Parameters())

    assert len(claims) == 3


@pytest.mark.parametrize("is_packed", [False, True])
def test_a_sample_has_its_four_lists_packed_or_not(is_packed):
    lists = ([1.0, 2.0], [3.0, 4.0], [-2.0, -2.0], [5.0, 6.0])
    packed = doubles(value for each in lists for value in each).tobytes()
    sample = (
        PackedSample(7.0, packed, 2) if is_packed else ControllerSample(7.0, *lists)
    )
    assert sample.columns == lists
    assert sample._asdict() == {
        "stamp": 7.0,
        "desired": sample.desired,
        "actual": sample.actual,
        "error": sample.error,
        "output": sample.output,
    }
    assert (sample.desired, sample.actual, sample.error, sample.output) == lists
    assert "output=[5.0, 6.0]" in repr(sample)


def test_a_packed_sample_keeps_what_the_controller_added():
    sample = PackedSample(7.0, doubles(range(10)).tobytes(), 2)
    assert sample.output == [6.0, 7.0]
    assert sample.column(4) == [8.0, 9.0]
