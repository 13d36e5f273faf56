"""Requests become the core's values."""

from station import wire
from station.api.routes import robots
from station.core.franka import FaultKind, GraspRequest

NOMINAL = {
    "lower_torque_thresholds_nominal": [20.0] * 7,
    "upper_torque_thresholds_nominal": [40.0] * 7,
    "lower_force_thresholds_nominal": [10.0] * 6,
    "upper_force_thresholds_nominal": [30.0] * 6,
}


def test_nominal_thresholds_count_for_both_phases():
    request = wire.ForceTorqueCollisionBehavior(**NOMINAL)

    found = robots.collision_thresholds(request.model_dump())

    assert found.upper_force_thresholds_acceleration == (30.0,) * 6
    assert found.lower_torque_thresholds_nominal == (20.0,) * 7


def test_fault_keeps_its_kind():
    found = robots.fault_of(wire.Fault(kind="stuck_joint", joint=3))

    assert (found.kind, found.joint) == (FaultKind.STUCK_JOINT, 3)


def test_the_request_of_a_grasp_is_read_back_unchanged():
    epsilon = wire.GraspEpsilon(inner=0.001, outer=0.002)
    request = wire.GripperGraspRequest(
        width=0.03, force=9.0, speed=0.05, epsilon=epsilon
    )

    assert robots.grasp_request(request) == GraspRequest(0.03, 9.0, 0.05, 0.001, 0.002)
