"""Which tests of the original are re-told where.

ros_controllers@678b92a runs 87 tests of its joint_trajectory_controller on a robot: 27
under three launch files (positions, positions with a stop ramp, velocities), one for
velocities alone, one for wrapping sensors, and four of tolerances. Those for partial
trajectories are in its sources and not in its build; they are re-told all the same.
"""

import ast
from pathlib import Path

import pytest

FOLDERS = [Path(__file__).parent, Path(__file__).parents[2] / "core" / "trajectory"]

CONTROLLER = {
    "stateTopicConsistency": (
        "test_the_state_tells_all_joints_but_no_measured_accelerations"
    ),
    "queryStateServiceConsistency": "test_the_desired_state_of_a_time_tells_all_joints",
    "invalidMessages": "test_a_goal_for_some_joints_is_refused",
    "topicSingleTraj": "test_a_published_trajectory_is_followed_to_its_end",
    "actionSingleTraj": "test_a_goal_is_followed_to_its_end_and_succeeds",
    "jointReordering": "test_joints_may_have_another_order",
    "jointWraparound": "test_continuous_joints_leave_whole_turns_out",
    "jointWraparoundPiSingularity": "test_half_a_turn_keeps_its_direction",
    "topicReplacesTopicTraj": "test_the_topic_replaces_what_is_executed",
    "actionReplacesActionTraj": "test_a_goal_replaces_what_is_executed",
    "actionReplacesTopicTraj": "test_a_goal_replaces_what_is_executed",
    "topicReplacesActionTraj": "test_the_topic_replaces_what_is_executed",
    "emptyTopicCancelsTopicTraj": (
        "test_an_empty_topic_message_stops_where_the_joints_are"
    ),
    "emptyTopicCancelsActionTraj": (
        "test_an_empty_topic_message_stops_where_the_joints_are"
    ),
    "emptyTopicCancelsActionTrajWithDelay": (
        "test_a_stop_ramp_does_not_turn_a_late_robot_round"
    ),
    "emptyTopicCancelsActionTrajWithDelayStopZero": (
        "test_a_stop_holds_or_ramps_what_is_desired_unless_a_joint_left_its_path"
    ),
    "emptyActionCancelsTopicTraj": (
        "test_an_empty_goal_stops_where_the_joints_are_and_succeeds"
    ),
    "emptyActionCancelsActionTraj": (
        "test_an_empty_goal_stops_where_the_joints_are_and_succeeds"
    ),
    "cancelActionGoal": "test_a_cancelled_goal_is_preempted_and_the_joints_stop",
    "ignoreOldTopicTraj": (
        "test_what_lies_in_the_past_is_refused_and_replaces_nothing"
    ),
    "ignoreOldActionTraj": (
        "test_what_lies_in_the_past_is_refused_and_replaces_nothing"
    ),
    "ignoreSingleOldActionTraj": "test_a_goal_that_was_over_before_it_came_is_refused",
    "ignorePartiallyOldActionTraj": "test_only_the_points_to_come_are_executed",
    "pathToleranceViolation": "test_a_joint_that_leaves_the_path_aborts_the_goal",
    "pathToleranceViolationSingleJoint": (
        "test_a_joint_that_leaves_the_path_aborts_the_goal"
    ),
    "goalToleranceViolation": "test_a_joint_that_arrives_too_late_aborts_the_goal",
    "goalToleranceViolationSingleJoint": (
        "test_a_joint_that_arrives_too_late_aborts_the_goal"
    ),
}
VELOCITY_ALONE = {
    "jointVelocityFeedForward": (
        "test_velocity_feed_forward_is_needed_to_stay_on_the_path"
    ),
}
WRAPPING = {
    "jointWrapping": "test_errors_of_wrapping_sensors_are_taken_the_short_way",
}
TOLERANCES = {
    "CheckStateTolerance": "test_each_quantity_has_its_own_bound",
    "UpdateStateTolerances": (
        "test_a_positive_request_replaces_a_negative_one_removes_and_zero_keeps"
    ),
    "UpdateSegmentTolerances": "test_requests_for_other_joints_change_nothing",
    "getSegmentTolerances": "test_defaults_are_read_from_the_constraints",
}
PARTIAL = {
    "invalidMessages": "test_what_is_wrong_with_all_joints_is_wrong_with_some",
    "allowPartialTrajIfSpecified": "test_a_goal_for_one_joint_becomes_active",
    "topicSinglePartialTraj": ("test_a_published_trajectory_for_one_joint_is_followed"),
    "actionSinglePartialTraj": "test_a_goal_for_one_joint_succeeds",
    "topicReplacesTopicTraj": (
        "test_the_topic_replaces_one_joint_and_the_other_goes_on"
    ),
    "actionReplacesActionTraj": (
        "test_a_goal_replaces_one_joint_and_the_other_goes_on"
    ),
    "actionReplacesTopicTraj": "test_a_goal_replaces_one_joint_and_the_other_goes_on",
    "topicReplacesActionTraj": (
        "test_the_topic_replaces_one_joint_and_the_other_goes_on"
    ),
    "ignoreOldTopicTraj": "test_what_lies_in_the_past_replaces_no_joint",
    "ignoreOldActionTraj": "test_what_lies_in_the_past_replaces_no_joint",
    "ignorePartiallyOldActionTraj": (
        "test_only_the_points_to_come_are_executed_for_one_joint"
    ),
    "executeParitalActionTrajInFuture": (
        "test_a_goal_for_one_joint_may_begin_after_the_present_trajectory"
    ),
}


def test_all_87_that_the_original_runs_are_counted():
    launched = 3 * len(CONTROLLER) + len(VELOCITY_ALONE) + len(WRAPPING)
    assert launched + len(TOLERANCES) == 87


@pytest.mark.parametrize(
    "table", [CONTROLLER, VELOCITY_ALONE, WRAPPING, TOLERANCES, PARTIAL]
)
def test_every_one_is_re_told(table):
    defined = {
        node.name
        for folder in FOLDERS
        for path in folder.glob("test_*.py")
        for node in ast.parse(path.read_text()).body
        if isinstance(node, ast.FunctionDef)
    }
    assert set(table.values()) <= defined
