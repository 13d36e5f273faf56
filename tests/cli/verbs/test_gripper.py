"""The verb that tells a gripper what to do."""

import json

import pytest

from station.cli.parser import parse
from station.cli.verbs import robot
from station.wire import Gripper, GripperCommand


def command(status="active", number="1", message=""):
    return GripperCommand(
        id=number,
        action="move",
        status=status,
        message=message,
        request={},
        started=0.0,
        ended=None if status == "active" else 1.0,
    )


def state(**fields):
    known = {
        "arm_id": "panda",
        "width": 0.03,
        "max_width": 0.08,
        "is_grasped": False,
        "temperature": 20.0,
        "time": 1.0,
        "activity": "idle",
        "force": 0.0,
        "command": None,
        "last": None,
    }
    return Gripper(**{**known, **fields})


class FakeGripper:
    """What `GripperClient` is to the command line."""

    def __init__(self):
        self.calls = []
        self.states = [state(command=command())]

    def _answer(self, *call):
        self.calls.append(call)
        return self.states.pop(0) if len(self.states) > 1 else self.states[0]

    def state(self):
        return self._answer("state")

    def homing(self):
        return self._answer("homing")

    def move(self, request):
        return self._answer("move", request.width, request.speed)

    def grasp(self, request):
        epsilon = request.epsilon
        return self._answer(
            "grasp", request.width, request.force, epsilon.inner, epsilon.outer
        )

    def stop(self):
        return self._answer("stop")


@pytest.fixture
def hand(station, monkeypatch):
    """Return the gripper of every arm; nobody waits for it."""
    fake = FakeGripper()
    arm = type("Arm", (), {"gripper": fake, "arm_id": "panda"})
    station.robot = lambda _: arm
    station.robots = lambda: [arm]
    monkeypatch.setattr(robot.time, "sleep", lambda _: None)
    return fake


@pytest.mark.parametrize(
    ("line", "call"),
    [
        ("state", ("state",)),
        ("panda stop", ("stop",)),
        ("homing --no-wait", ("homing",)),
        ("move 0.02 --speed 0.05 --no-wait", ("move", 0.02, 0.05)),
        ("panda grasp 0.03 20 --no-wait", ("grasp", 0.03, 20.0, 0.005, 0.005)),
        ("grasp 0 5 --inner 0 --outer 0.01 --no-wait", ("grasp", 0.0, 5.0, 0.0, 0.01)),
    ],
)
def test_words_become_calls(run, hand, line, call):
    assert run(f"gripper {line}").code == 0
    assert hand.calls == [call]


def test_it_waits_for_the_end(run, hand):
    active, done = state(command=command()), state(last=command("succeeded"))
    hand.states = [active, active, done]

    outcome = run("gripper move 0.03")

    assert outcome.code == 0
    assert "width 30.0 mm" in outcome.out
    assert "succeeded" in outcome.out


@pytest.mark.parametrize(
    "last", [command("aborted", message="Blocked."), command("succeeded", number="2")]
)
def test_a_command_that_does_not_get_there_is_a_failure(run, hand, last):
    hand.states = [state(command=command()), state(last=last)]

    outcome = run("gripper move 0.03")

    assert outcome.code == 1
    assert last.message in outcome.out


def test_ctrl_c_stops_the_gripper(run, hand, monkeypatch):
    def interrupt(_):
        raise KeyboardInterrupt

    monkeypatch.setattr(robot.time, "sleep", interrupt)

    assert run("gripper move 0.03").code == 130
    assert hand.calls[-1] == ("stop",)


def test_json_is_the_state(run, hand):
    hand.states = [state(width=None, is_grasped=True)]

    assert json.loads(run("gripper state --json").out)["is_grasped"] is True
    assert "width unknown, something is grasped" in run("gripper state").out


@pytest.mark.parametrize(
    "line", ["move", "move x", "grasp 0.03", "grasp 0.03 20 5", "panda", "panda open"]
)
def test_what_says_nothing_is_wrong_usage(run, hand, line):
    outcome = run(f"gripper {line}")

    assert outcome.code == 2
    assert "grasp WIDTH FORCE" in outcome.err
    assert hand.calls == []


def test_one_of_several_arms_must_be_named(run, hand, station):
    station.robots = list

    assert run("gripper state").code == 2
    assert hand.calls == []


def test_options_have_the_defaults_of_the_api():
    options = parse(["gripper", "move", "0.08"])

    assert (options.words, options.speed) == (["move", "0.08"], 0.1)
    assert (options.inner, options.outer) == (0.005, 0.005)
    assert not options.no_wait
