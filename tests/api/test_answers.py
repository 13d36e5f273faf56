"""From the core's values to the wire: nothing is lost, nothing is infinite."""

import math
from dataclasses import replace

import pytest

from station.api import answers
from station.core.control.controller import ControllerSample
from station.core.control.switching import SwitchPlan, SwitchRequest, SwitchResult
from station.core.control.tunables import Gains, Tunable
from station.core.description.urdf_repair import Repair
from station.core.facade.station import HardwareReport
from station.core.franka import (
    ArmError,
    GripperAction,
    GripperActivity,
    GripperCommand,
    GripperState,
    RobotMode,
    RobotState,
)
from station.core.franka.arms import ArmReport
from station.core.franka.franka_errors import ERROR_INDEX
from station.core.hardware.limits import (
    Clamp,
    ClampReason,
    JointLimits,
    SoftJointLimits,
)
from station.core.hardware.robot_report import ClampReport, JointLimitsReport
from station.core.ports.goal import GoalStatus
from station.core.ports.set_point import SetPoint, SetPointElement
from station.events import EventLog
from station.reports import (
    Clearance,
    HardwareInterface,
    HardwareResource,
    HardwareTransmission,
)
from station.wire import FrankaState
from tests.api.spring import make_station


@pytest.fixture
def station():
    station = make_station()
    station.load_controller("spring", "test/Spring", {"joint": "j"})
    station.switch_controllers(SwitchRequest(start=("spring",)))
    station.loop.step()
    return station


def test_unlimited_set_points_have_no_bounds():
    element = SetPointElement("j", "rad")

    info = answers.command_info(SetPoint((element,), (math.nan,)))

    assert info.elements[0].minimum is None
    assert info.elements[0].maximum is None
    assert info.last == [None]
    assert answers.command_info(SetPoint((element,), None)).last is None


def test_unlimited_gains_have_no_bounds():
    gains = answers.gains(
        Gains({"p": 1.0}, {"p": Tunable("", 0.0, math.inf)}, 3), '"e"'
    )

    assert gains.tunables["p"].maximum is None
    assert (gains.revision, gains.etag) == (3, '"e"')


def test_a_sample_with_holes():
    sample = ControllerSample(0.1, [math.nan], [1.0], [math.nan], [2.0])

    told = answers.controller_sample(sample, ["j"])

    assert (told.desired, told.actual, told.output) == ([None], [1.0], [2.0])


def test_the_answer_of_a_switch_names_failed_and_ignored_controllers():
    plan = SwitchPlan((), (), (), (), (), ignored=("b is unknown",))
    result = SwitchResult(
        ok=False,
        started=("a",),
        stopped=(),
        cycle=7,
        plan=plan,
        failed={"c": "why"},
        jump={"j": math.inf},
    )

    told = answers.switch_result(result)

    assert told.failed == {"c": "why"}
    assert told.ignored == ["b is unknown"]
    assert told.jump == {"j": None}
    assert not told.dry_run


def test_controllers(station):
    (spring,) = answers.controllers(station).controllers

    assert spring.state == "running"
    assert spring.claimed_resources[0].resources == ["j"]
    assert spring.time.count >= 0


def test_status_loop_stop_and_joints(station):
    status = answers.status(station, {"station": "1"}, EventLog().state())

    assert status.loop.cycles == station.loop.cycle
    assert answers.stop_state(station).state == status.stop_state == "armed"
    states = answers.joint_states(station.latest(), station.joint_names)
    assert states.stamp == status.time


def test_errors_are_reported_by_name():
    state = RobotState(robot_mode=RobotMode.REFLEX)
    state.current_errors[ERROR_INDEX["joint_reflex"]] = True
    state.doubles("q")[0] = float("nan")

    pair = Clearance(
        "panda", "link5", "wall", 0.03, 0.02, is_slowing=False, interventions=0
    )
    found = FrankaState.model_validate(answers.franka_state(state, pair))

    assert found.current_errors == ["joint_reflex"]
    assert found.robot_mode == "reflex"
    assert found.q[0] is None
    assert (found.least_clearance, found.nearest_pair) == (0.03, ["link5", "wall"])


def test_report_describes_its_errors():
    error = ArmError("joint_reflex", "joint2", 25.0, 20.0, "Nm", 7)

    found = answers.arm_report(
        ArmReport(
            arm_id="panda",
            robot_mode=RobotMode.REFLEX,
            is_connected=True,
            errors=(error,),
            remedy="recover",
        )
    )

    assert found.errors[0].description == (
        "joint_reflex at joint2: 25 Nm, allowed is 20 Nm (cycle 7)"
    )


IDLE = GripperState(
    width=0.08,
    max_width=0.08,
    is_grasped=False,
    temperature=20.0,
    time=1.0,
    activity=GripperActivity.IDLE,
    force=0.0,
    command=None,
    last=None,
)


@pytest.mark.parametrize("activity", GripperActivity)
def test_every_activity_has_its_name(activity):
    found = answers.gripper("panda", replace(IDLE, activity=activity, force=math.nan))

    assert (found.activity, found.force) == (activity.value, None)


@pytest.mark.parametrize("action", GripperAction)
@pytest.mark.parametrize("status", list(GoalStatus)[1:])
def test_every_gripper_action_and_status_has_an_answer(action, status):
    command = GripperCommand(3, action, status, "why", {"width": 0.1}, 1.0, 2.0)

    found = answers.gripper("panda", replace(IDLE, last=command)).last

    assert (found.id, found.action, found.status) == ("3", action.value, status.value)
    assert (found.request, found.message) == ({"width": 0.1}, "why")


EFFORT = "hardware_interface::EffortJointInterface"


def test_hardware_answer_has_interfaces_limits_transmissions_and_clamps():
    report = HardwareReport(
        (HardwareInterface(EFFORT, (HardwareResource("j", ("arm",)),)),),
        (
            JointLimitsReport(
                "j",
                JointLimits(min_position=-1.0, max_position=1.0, max_effort=math.inf),
                SoftJointLimits(-0.9, 0.9, 10.0, 20.0),
                {"position": "urdf limit", "soft": "parameters"},
            ),
        ),
        (HardwareTransmission("t", "a/B", ("j",), ("m",)),),
        (ClampReport(EFFORT, 3, Clamp("j", math.inf, 5.0, ClampReason.EFFORT)),),
        (Repair("range", "joint 'j'", "its range is empty", "0 to 0", "locked"),),
    )

    told = answers.hardware(report)
    assert told.repairs[0].new == "locked"

    assert told.interfaces[0].resources[0].claimed_by == ("arm",)
    limits = told.limits[0]
    assert (limits.min_position, limits.max_velocity) == (-1.0, None)
    assert limits.max_effort is None
    assert limits.soft_limits.k_velocity == 20.0
    assert limits.sources == {"position": "urdf limit", "soft": "parameters"}
    assert told.transmissions[0].actuators == ("m",)
    clamp = told.clamps[0]
    assert (clamp.count, clamp.asked, clamp.given) == (3, None, 5.0)
    assert clamp.reason == "effort"
