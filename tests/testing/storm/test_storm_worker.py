"""Controllers of the storm move a little, and misbehave once when told to."""

import pytest

from station.core import ControllerLoadError
from station.testing.scripted import ScriptedBench
from station.testing.storm.storm_worker import (
    BAD_COMMANDS,
    Mischief,
    StormController,
)

VELOCITY = "hardware_interface::VelocityJointInterface"


@pytest.fixture
def bench():
    return ScriptedBench()


@pytest.fixture
def controller(bench):
    return bench.load_controller(
        "it", StormController, interface=VELOCITY, resources=["j1"]
    )


def test_it_claims_what_its_parameters_say_and_moves(bench, controller):
    assert bench.switch(["it"]).ok
    bench.step(3)

    (claim,) = bench.status("it").claimed_resources
    assert (claim.hardware_interface, claim.resources) == (VELOCITY, ("j1",))
    assert bench.robot.joints.velocity_command[0] > 0.0
    assert controller.find_overwritten() is None


def test_it_notices_that_its_command_is_overwritten(bench, controller):
    bench.switch(["it"])
    bench.step()
    bench.robot.joints.velocity_command[0] = 5.0

    assert "is commanded 5.0" in controller.find_overwritten()


def test_it_raises_once_where_it_is_told_to(bench, controller):
    controller.mischief = Mischief("update")
    bench.switch(["it"])
    bench.step()

    assert "the storm lets this callback fail" in bench.fault("it")
    assert (controller.mischief, controller.mischiefs) == (None, 1)


@pytest.mark.parametrize("command", BAD_COMMANDS)
def test_it_commands_what_is_refused(bench, controller, command):
    controller.mischief = Mischief("update", (command,))
    bench.switch(["it"])
    bench.step()

    assert bench.state("it") == "aborted"
    assert bench.robot.joints.velocity_command == [0.0] * 3


def test_it_refuses_resources_that_the_robot_has_not(bench):
    with pytest.raises(ControllerLoadError, match="no commands"):
        bench.load_controller(
            "it", StormController, interface=VELOCITY, resources=["j9"]
        )
