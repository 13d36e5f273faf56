"""Arms on their way to the wire and back."""

from station import wire as schemas
from station.api import robot_wire
from station.core.facade.robots import ArmReport
from station.core.franka import ArmError, FaultKind, RobotMode, RobotState
from station.core.franka.franka_errors import ERROR_INDEX

NOMINAL = {
    "lower_torque_thresholds_nominal": [20.0] * 7,
    "upper_torque_thresholds_nominal": [40.0] * 7,
    "lower_force_thresholds_nominal": [10.0] * 6,
    "upper_force_thresholds_nominal": [30.0] * 6,
}


def test_errors_are_told_by_name():
    state = RobotState(robot_mode=RobotMode.REFLEX)
    state.current_errors[ERROR_INDEX["joint_reflex"]] = True
    state.q[0] = float("nan")

    found = robot_wire.franka_state(state)

    assert found.current_errors == ["joint_reflex"]
    assert found.robot_mode == "reflex"
    assert found.q[0] is None


def test_report_describes_its_errors():
    error = ArmError("joint_reflex", "joint2", 25.0, 20.0, "Nm", 7)

    found = robot_wire.arm_report(
        ArmReport(
            arm_id="panda",
            mode=RobotMode.REFLEX,
            is_connected=True,
            errors=(error,),
            remedy="recover",
        )
    )

    assert found.errors[0].description == (
        "joint_reflex at joint2: 25 Nm, allowed is 20 Nm (cycle 7)"
    )


def test_nominal_thresholds_count_for_both_phases():
    request = schemas.ForceTorqueCollisionBehavior(**NOMINAL)

    found = robot_wire.collision_behavior(request)

    assert found.upper_force_thresholds_acceleration == (30.0,) * 6
    assert found.lower_torque_thresholds_nominal == (20.0,) * 7


def test_fault_keeps_its_kind():
    found = robot_wire.fault(schemas.Fault(kind="stuck_joint", joint=3))

    assert (found.kind, found.joint) == (FaultKind.STUCK_JOINT, 3)
