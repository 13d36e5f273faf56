"""The verb that shows the robot."""

import json

from station.reports import examples_of
from station.wire import Hardware

EXAMPLE = Hardware.model_validate(examples_of(Hardware.__doc__)[0])


def test_resources_are_listed_with_who_claims_them(run, station):
    station.hardware = lambda: EXAMPLE
    outcome = run("list_hardware_interfaces")

    line = outcome.out.splitlines()[1].split()
    assert line == ["elbow_joint", "hardware_interface::EffortJointInterface", "arm"]
    assert "elbow_trans" not in outcome.out


def test_limits_transmissions_and_clamps_are_listed_when_asked_for(run, station):
    station.hardware = lambda: EXAMPLE
    out = run("list-hardware-interfaces -v").out

    assert "-3.14 to 3.14" in out
    assert "elbow_trans" in out
    assert "its range is empty" in out
    assert out.splitlines()[-1].split()[-4:] == ["12", "400", "150", "effort"]


def test_hardware_can_be_json(run, station):
    station.hardware = lambda: EXAMPLE
    told = json.loads(run("list_hardware_interfaces --json").out)
    assert told == EXAMPLE.model_dump(mode="json")
