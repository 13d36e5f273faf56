"""Hardware that is not active takes no commands, and no user loses what it has."""

import pytest

from station.core.control.hardware_components import ComponentState
from station.core.control.switching import Strictness
from station.core.errors import (
    HardwareComponentError,
    HardwareComponentNotFoundError,
    ParameterError,
    SwitchRefusedError,
)
from station.core.hardware.combined_robot_hw import CombinedRobotHW
from station.core.hardware.robot_hw import HardwareComponent
from station.hw.mock import MockRobotHW
from station.testing import Bench

GROUP = "effort_controllers/JointGroupEffortController"
ACTIVE, INACTIVE = ComponentState.ACTIVE, ComponentState.INACTIVE
UNCONFIGURED, FINALIZED = ComponentState.UNCONFIGURED, ComponentState.FINALIZED


class NotedHW(MockRobotHW):
    """A mock that notes its hooks; `failing` has what they raise."""

    def __init__(self):
        super().__init__()
        self.hooks = []
        self.failing = {}

    def _note(self, hook, component):
        self.hooks.append((hook, component))
        if hook in self.failing:
            raise self.failing[hook]

    def on_configure(self, component):
        self._note("on_configure", component)

    def on_cleanup(self, component):
        self._note("on_cleanup", component)

    def on_activate(self, component):
        self._note("on_activate", component)

    def on_deactivate(self, component):
        self._note("on_deactivate", component)

    def on_shutdown(self, component):
        self._note("on_shutdown", component)

    def on_error(self, component, problem):
        self._note(f"on_error: {problem}", component)


def make_bench(**initial):
    """Return a bench of two robots, `left` with l1 and l2, `right` with r1 and r2."""
    robots = {"left": NotedHW(), "right": NotedHW()}
    combined = CombinedRobotHW(lambda kind: robots[kind])
    parameters = {"robot_hardware": list(robots)}
    for name in robots:
        joints = [f"{name[0]}{n}" for n in (1, 2)]
        parameters[name] = {"type": name, "joints": joints}
    manager = {"hardware_components_initial_state": initial} if initial else {}
    bench = Bench(combined, parameters, root_parameters={"controller_manager": manager})
    bench.robots = robots
    for name in robots:
        joints = parameters[name]["joints"]
        bench.load_controller(f"{name}_arm", GROUP, joints=joints)
    return bench


def states(bench):
    return {one.name: one.state for one in bench.manager.hardware_components()}


def set_state(bench, name, state):
    bench.manager.set_hardware_component_state(name, state)


def test_every_robot_of_a_combined_one_is_a_component_and_begins_active():
    bench = make_bench()
    assert states(bench) == {"left": "active", "right": "active"}
    hooks = [("on_configure", "robot"), ("on_activate", "robot")]
    assert bench.robots["left"].hooks == bench.robots["right"].hooks == hooks
    left = bench.manager.hardware_components()[0]
    commanded = {each.resource for each in left.command_interfaces}
    assert commanded == {"l1", "l2"}
    assert "l1" in {each.resource for each in left.state_interfaces}


def test_initial_states_are_those_of_the_parameters():
    bench = make_bench(inactive=["left"], unconfigured=["right"])
    assert states(bench) == {"left": "inactive", "right": "unconfigured"}
    assert bench.robots["right"].hooks == []
    with pytest.raises(HardwareComponentNotFoundError, match="'lift'"):
        make_bench(inactive=["lift"])
    with pytest.raises(ParameterError, match="no state of hardware"):
        make_bench(asleep=["left"])


def test_what_is_not_active_takes_no_controller():
    bench = make_bench(inactive=["left"])
    with pytest.raises(
        SwitchRefusedError, match=r"'left_arm' .*'l1' .*'left', which is inactive"
    ):
        bench.switch(["right_arm", "left_arm"])
    assert bench.manager.running_names() == []
    result = bench.switch(["right_arm", "left_arm"], strictness=Strictness.BEST_EFFORT)
    assert result.started == ("right_arm",)
    assert "which is inactive" in result.plan.ignored[0]
    set_state(bench, "left", ACTIVE)
    assert bench.switch(["left_arm"]).started == ("left_arm",)


def test_a_component_in_use_stays_active():
    bench = make_bench()
    bench.switch(["left_arm"])
    with pytest.raises(HardwareComponentError, match="in use by left_arm") as caught:
        set_state(bench, "left", UNCONFIGURED)
    assert caught.value.details["users"] == ["left_arm"]
    assert states(bench)["left"] == "active"
    assert bench.robots["left"].hooks[2:] == []
    set_state(bench, "right", INACTIVE)  # nobody uses that one
    bench.switch([], ["left_arm"])
    set_state(bench, "left", INACTIVE)
    assert states(bench) == {"left": "inactive", "right": "inactive"}


def test_the_hooks_on_the_way_are_called_in_order():
    bench = make_bench()
    hooks = bench.robots["left"].hooks
    del hooks[:]
    for state in (UNCONFIGURED, INACTIVE, INACTIVE, ACTIVE, FINALIZED):
        set_state(bench, "left", state)
    assert [hook for hook, _ in hooks] == [
        "on_deactivate", "on_cleanup", "on_configure", "on_activate", "on_shutdown",
    ]  # fmt: skip
    with pytest.raises(HardwareComponentError, match="is finalized"):
        set_state(bench, "left", ACTIVE)


def test_a_hook_that_refuses_leaves_the_state_and_one_that_fails_does_not():
    bench = make_bench()
    left = bench.robots["left"]
    left.failing = {
        "on_deactivate": HardwareComponentError("The brake is stuck.", remedy="Push.")
    }
    with pytest.raises(HardwareComponentError, match="brake is stuck") as caught:
        set_state(bench, "left", INACTIVE)
    assert caught.value.remedy == "Push."
    assert states(bench)["left"] == "active"
    assert bench.switch(["left_arm"]).ok
    bench.switch([], ["left_arm"])

    left.failing = {"on_deactivate": OSError("no cable")}
    with pytest.raises(HardwareComponentError, match="no cable"):
        set_state(bench, "left", INACTIVE)
    component = bench.manager.hardware_components()[0]
    assert (component.state, "no cable" in component.problem) == ("unconfigured", True)
    assert "no cable" in left.hooks[-1][0]
    set_state(bench, "left", ACTIVE)
    assert bench.manager.hardware_components()[0].problem == ""

    left.on_error = lambda *_: 1 / 0
    left.failing = {"on_deactivate": OSError("smoke")}
    with pytest.raises(HardwareComponentError):
        set_state(bench, "left", INACTIVE)
    assert states(bench)["left"] == "finalized"


def test_a_fallback_does_not_start_on_hardware_that_is_not_active():
    bench = make_bench()
    both = {"joints": ["r1", "l1"]}
    bench.load_controller("both", GROUP, **both)
    bench.load_controller("right_only", GROUP, joints=["r1"], fallback=["both"])
    bench.switch(["right_only"])
    set_state(bench, "left", INACTIVE)
    bench.manager.get_controller("right_only").update = lambda *_: 1 / 0
    bench.step()
    assert bench.manager.running_names() == []
    assert "'left', which is inactive" in bench.fault("right_only")


def test_parts_of_one_robot_have_their_own_resources_and_names():
    class TwoParts(NotedHW):
        def components(self):
            return [
                HardwareComponent(name, self, resources=frozenset({joint}))
                for name, joint in (("a", "joint1"), ("b", "joint2"))
            ]

    robot = TwoParts()
    combined = CombinedRobotHW(lambda _: robot)
    bench = Bench(combined, {"robot_hardware": ["x"], "x": {"type": "x"}})
    bench.load_controller("one", GROUP, joints=["joint1"])
    set_state(bench, "x_b", INACTIVE)
    assert bench.switch(["one"]).ok
    assert robot.hooks[-1] == ("on_deactivate", "b")
    with pytest.raises(HardwareComponentError, match="in use by one"):
        set_state(bench, "x_a", INACTIVE)
