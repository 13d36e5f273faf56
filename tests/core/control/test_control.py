"""What people are told about controllers and joints: the shapes."""

from dataclasses import fields

from station.core.control.controller import (
    ControllerStatistics,
    ControllerStatus,
    JointStates,
)


def test_the_status_has_what_the_message_controller_state_has():
    names = {field.name for field in fields(ControllerStatus)}

    assert {"name", "type", "state", "claimed_resources"} <= names


def test_the_statistics_have_what_the_message_controller_statistics_has():
    names = {field.name for field in fields(ControllerStatistics)}

    assert {
        "name",
        "type",
        "timestamp",
        "running",
        "max_time",
        "mean_time",
        "variance_time",
        "num_control_loop_overruns",
        "time_last_control_loop_overrun",
    } <= names


def test_the_fields_are_those_of_the_message():
    assert JointStates._fields == ("stamp", "name", "position", "velocity", "effort")
