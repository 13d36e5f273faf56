"""Chains: references are claimed, commanded in order, and end with what they need."""

import pytest
from typing_extensions import override

from station.controllers.position_controllers import JointGroupPositionController
from station.core.control.chainable_controller import (
    ChainableController,
    ExportedState,
    ExportedStateInterface,
    Reference,
    ReferenceInterface,
)
from station.core.control.controller import Controller, ControllerState
from station.core.control.controller_loader import TableLoader
from station.core.control.switching import Strictness
from station.core.errors import (
    ControllerLoadError,
    ControllerStateError,
    ResourceConflictError,
    SwitchRefusedError,
)
from station.core.hardware.interfaces import (
    EffortJointInterface,
    PositionJointInterface,
)
from station.memory.doubles import zeros
from station.reports import ExportedValue
from station.testing.bench import Bench

RUNNING = ControllerState.RUNNING
PERIOD = 0.01
order = []


class Spring(ChainableController):
    """Pulls a joint to its reference, and exports the spring's length."""

    required_interfaces = (EffortJointInterface,)

    @override
    def init(self, hw, params):
        self.joint = hw.get(EffortJointInterface).get_handle(params.get_str("joint"))
        self.references, self.lengths = zeros(1), zeros(1)
        self.own = 0.0
        self.modes = []
        self.accepts = True
        self.fails = False
        self.name = params.get_str("joint")

    @override
    def on_export_reference_interfaces(self):
        rest = self.joint.get_position
        return [Reference(f"{self.name}/position", self.references, 0, rest)]

    @override
    def on_export_state_interfaces(self):
        return [ExportedState(f"{self.name}/length", self.lengths)]

    @override
    def on_set_chained_mode(self, chained_mode):
        self.modes.append(chained_mode)
        return self.accepts

    @override
    def starting(self, time):
        self.references[0] = self.joint.get_position()

    @override
    def update_reference_from_subscribers(self, time, period):
        self.references[0] = self.own

    @override
    def update_and_write_commands(self, time, period):
        order.append("spring")
        if self.fails:
            raise RuntimeError("the spring broke")
        self.lengths[0] = self.references[0] - self.joint.get_position()
        self.joint.set_command(2.0 * self.lengths[0])


class Cascade(ChainableController):
    """Passes its reference on, doubled."""

    @override
    def init(self, hw, params):
        references = hw.get(ReferenceInterface)
        self.out = references.get_handle(params.get_str("reference"))
        self.references = zeros(1)
        self.value = 0.0

    @override
    def on_export_reference_interfaces(self):
        return [Reference("scale", self.references)]

    @override
    def update_and_write_commands(self, time, period):
        order.append("cascade")
        value = self.references[0] if self.is_in_chained_mode else self.value
        self.out.set_command(2.0 * value)


class Joint(Controller[PositionJointInterface]):
    """Commands a position through the interface of joints."""

    hardware_interface = PositionJointInterface

    @override
    def init(self, interface, params):
        self.joint = interface.get_handle(params.get_str("joint"))
        self.value = 0.0

    @override
    def update(self, time, period):
        order.append("joint")
        self.joint.set_command(self.value)


class Scale(Controller[ReferenceInterface]):
    """Commands the reference of a cascade, and reads a state."""

    hardware_interface = ReferenceInterface

    @override
    def init(self, interface, params):
        self.out = interface.get_handle(params.get_str("reference"))
        self.value = 0.0

    @override
    def update(self, time, period):
        order.append("scale")
        self.out.set_command(self.value)


class Gauge(Controller[ExportedStateInterface]):
    """Reads a state of another controller."""

    hardware_interface = ExportedStateInterface

    @override
    def init(self, interface, params):
        self.handle = interface.get_handle(params.get_str("state"))

    @override
    def update(self, time, period):
        self.seen = self.handle.get_value()


@pytest.fixture
def bench():
    order.clear()
    types = {f"test/{c.__name__}": c for c in (Spring, Cascade, Joint, Scale, Gauge)}
    bench = Bench(
        robot_parameters={"joints": ["j1", "j2"]},
        loaders=[TableLoader(types)],
        period=PERIOD,
    )
    bench.load_controller("spring", "test/Spring", joint="j1")
    return bench


def load_chain(bench):
    """Load scale → cascade → spring, and return the three."""
    bench.load_controller("cascade", "test/Cascade", reference="spring/j1/position")
    bench.load_controller("scale", "test/Scale", reference="cascade/scale")
    return [bench.manager.get_controller(n) for n in ("scale", "cascade", "spring")]


def broken(*_):
    raise RuntimeError("it broke")


def running(bench):
    return bench.manager.running_names()


def test_a_reference_drives_the_robot_in_the_cycle_in_which_it_is_commanded(bench):
    scale, _, spring = load_chain(bench)
    bench.switch(start=["scale", "cascade", "spring"])
    bench.step()
    scale.value = 0.25
    order.clear()

    bench.step()

    assert order == ["scale", "cascade", "spring"]
    assert spring.joint.get_command() == pytest.approx(2.0 * 2.0 * 0.25)
    assert spring.is_in_chained_mode
    assert spring.modes == [True]


def test_a_joint_controller_commands_a_reference_as_a_joint(bench):
    joint = bench.load_controller("line", "test/Joint", joint="spring/j1")
    bench.switch(start=["spring", "line"])
    bench.step()
    joint.value = 0.3

    bench.step()

    spring = bench.manager.get_controller("spring")
    assert spring.joint.get_command() == pytest.approx(2.0 * 0.3)
    assert bench.manager.running()[0].references == ("spring/j1/position",)


def test_a_stopped_preceding_controller_leaves_the_follower_to_its_set_points(bench):
    line = bench.load_controller("line", "test/Joint", joint="spring/j1")
    spring = bench.manager.get_controller("spring")
    spring.own = 0.1
    bench.switch(start=["spring", "line"])
    bench.step()
    line.value = 0.3
    bench.step()

    bench.switch(stop=["line"])
    bench.step()

    assert not spring.is_in_chained_mode
    assert spring.references[0] == pytest.approx(0.1)
    assert running(bench) == ["spring"]


@pytest.mark.parametrize(
    ("reference", "advice"),
    [
        ("later/scale", "References of a controller 'later' exist once it is loaded."),
        ("ring/scale", "A controller cannot command its own references."),
    ],
)
def test_a_reference_that_is_not_there_yet_is_told_with_its_owner(
    bench, reference, advice
):
    with pytest.raises(ControllerLoadError, match=reference) as refused:
        bench.load_controller("ring", "test/Cascade", reference=reference)

    assert refused.value.remedy.endswith(advice)


def test_two_controllers_cannot_command_one_reference(bench):
    bench.load_controller("line", "test/Joint", joint="spring/j1")
    bench.load_controller("other", "test/Scale", reference="spring/j1/position")
    bench.switch(start=["spring", "line"])

    with pytest.raises(ResourceConflictError, match="spring/j1/position"):
        bench.switch(start=["other"])

    bench.switch(start=["other"], stop=["line"])
    assert running(bench) == ["other", "spring"]


def test_a_failure_ends_the_chain_in_the_same_cycle_and_starts_fallbacks(bench):
    _, _, spring = load_chain(bench)
    bench.load_controller("safe", "test/Spring", joint="j2")
    bench.load_controller(
        "last", "test/Scale", reference="cascade/scale", fallback=["safe"]
    )
    bench.switch(start=["last", "cascade", "spring"])
    bench.step()
    spring.fails = True

    bench.step()

    assert running(bench) == ["safe"]
    statuses = {one.name: one for one in bench.manager.list_controllers()}
    assert "the spring broke" in statuses["spring"].fault
    assert "'spring' does not run" in statuses["cascade"].fault
    assert "'cascade' does not run" in statuses["last"].fault
    assert statuses["last"].state is ControllerState.ABORTED


def test_a_failure_at_the_top_ends_the_chain_below_before_its_fallback_starts(bench):
    bench.load_controller("safe", "test/Spring", joint="j1")
    _, cascade, spring = load_chain(bench)
    bench.load_controller(
        "last", "test/Scale", reference="cascade/scale", fallback=["safe"]
    )
    last = bench.manager.get_controller("last")
    bench.switch(start=["last", "cascade", "spring"])
    bench.step()
    last.update = broken

    bench.step()

    # The fallback takes the joint of the spring, at the other end of the chain.
    assert running(bench) == ["safe"]
    assert "it broke" in bench.fault("last")
    assert "'last', which commanded it, has failed" in bench.fault("cascade")
    assert "'cascade', which commanded it, has failed" in bench.fault("spring")
    assert not cascade.is_in_chained_mode
    assert not spring.is_in_chained_mode


def test_a_fallback_may_take_the_references_over(bench):
    _, cascade, _ = load_chain(bench)
    for name, fallback in (("second", []), ("first", ["second"])):
        bench.load_controller(
            name, "test/Scale", reference="cascade/scale", fallback=fallback
        )
    bench.switch(start=["first", "cascade", "spring"])
    bench.step()
    bench.manager.get_controller("first").update = broken

    bench.step()

    assert running(bench) == ["second", "cascade", "spring"]
    assert cascade.is_in_chained_mode


def test_a_start_that_fails_leaves_the_controller_below_alone(bench):
    bench.load_controller("line", "test/Joint", joint="spring/j1")
    bench.manager.get_controller("line").starting = broken
    bench.switch(start=["spring"])

    bench.switch(start=["line"], strictness=Strictness.BEST_EFFORT)

    assert running(bench) == ["spring"]


def test_a_follower_that_refuses_chained_mode_keeps_its_predecessor_off(bench):
    bench.load_controller("line", "test/Joint", joint="spring/j1")
    spring = bench.manager.get_controller("spring")
    bench.switch(start=["spring"])
    spring.accepts = False

    with pytest.raises(SwitchRefusedError, match="refuses chained mode"):
        bench.switch(start=["line"])

    assert running(bench) == ["spring"]
    assert not spring.is_in_chained_mode


def test_an_exported_state_is_read_in_the_same_cycle(bench):
    gauge = bench.load_controller("gauge", "test/Gauge", state="spring/j1/length")
    bench.manager.get_controller("spring").own = 0.2
    bench.switch(start=["spring", "gauge"])

    bench.step()

    assert gauge.seen == pytest.approx(0.2)


def test_who_reads_a_state_runs_with_the_controller_that_exports_it(bench):
    bench.load_controller("gauge", "test/Gauge", state="spring/j1/length")

    with pytest.raises(SwitchRefusedError, match="reads states of 'spring'") as refused:
        bench.switch(start=["gauge"])
    assert refused.value.details["add"] == ["spring"]
    bench.switch(start=["gauge"], strictness=Strictness.AUTO)
    assert running(bench) == ["spring", "gauge"]

    with pytest.raises(SwitchRefusedError, match="are read by 'gauge'") as refused:
        bench.switch(stop=["spring"])
    assert refused.value.details["add"] == ["gauge"]
    bench.manager.get_controller("spring").fails = True
    bench.step()
    assert running(bench) == []
    assert "'spring', whose states it reads, does not run" in bench.fault("gauge")


def test_a_reader_that_fails_leaves_the_controller_that_exports(bench):
    bench.load_controller("gauge", "test/Gauge", state="spring/j1/length")
    bench.switch(start=["gauge", "spring"])
    bench.manager.get_controller("gauge").update = broken
    bench.step()

    assert running(bench) == ["spring"]


def test_what_others_claim_cannot_be_unloaded(bench):
    load_chain(bench)

    with pytest.raises(ControllerStateError, match="claimed by cascade"):
        bench.manager.unload_controller("spring")

    for name in ("scale", "cascade", "spring"):
        bench.manager.unload_controller(name)
    assert bench.manager.list_controllers() == []


def test_a_start_names_all_that_is_missing_down_the_chain(bench):
    load_chain(bench)

    with pytest.raises(SwitchRefusedError, match="commands 'cascade'") as refused:
        bench.switch(start=["scale"])

    assert refused.value.remedy == "Add 'cascade', 'spring' to 'start'."
    assert refused.value.details["add"] == ["cascade", "spring"]
    assert running(bench) == []


def test_a_stop_names_all_that_must_stop_as_well(bench):
    load_chain(bench)
    bench.switch(start=["scale", "cascade", "spring"])

    with pytest.raises(SwitchRefusedError, match="commanded by 'cascade'") as refused:
        bench.switch(stop=["spring"])
    assert refused.value.remedy == "Add 'scale', 'cascade' to 'stop'."
    bench.switch(stop=["spring"], strictness=Strictness.BEST_EFFORT)
    assert running(bench) == ["scale", "cascade", "spring"]

    bench.switch(stop=["scale", "cascade", "spring"])
    assert running(bench) == []


def test_auto_starts_and_stops_whole_chains(bench):
    load_chain(bench)

    started = bench.switch(start=["scale"], strictness=Strictness.AUTO)
    assert running(bench) == ["scale", "cascade", "spring"]
    assert started.plan.chained == ("cascade", "spring")

    bench.switch(stop=["spring"], strictness=Strictness.AUTO)
    assert running(bench) == []


def test_force_auto_stops_who_is_in_the_way(bench):
    load_chain(bench)
    bench.load_controller("stiff", "test/Spring", joint="j1")
    bench.switch(start=["scale", "cascade", "spring"])

    with pytest.raises(ResourceConflictError):
        bench.switch(start=["stiff"], strictness=Strictness.AUTO)
    bench.switch(start=["stiff"], strictness=Strictness.FORCE_AUTO)

    assert running(bench) == ["stiff"]


def test_best_effort_starts_nobody_without_the_one_it_commands(bench):
    load_chain(bench)

    bench.switch(start=["scale"], strictness=Strictness.BEST_EFFORT)

    assert running(bench) == []


def test_the_report_on_chains_says_who_commands_whom(bench):
    load_chain(bench)
    bench.load_controller("gauge", "test/Gauge", state="spring/j1/length")
    bench.switch(start=["cascade", "spring"])

    found = {one.name: one for one in bench.manager.chains().controllers}

    assert list(found) == ["scale", "cascade", "spring", "gauge"]
    assert found["cascade"].following == ("spring",)
    assert found["spring"].references == (
        ExportedValue("spring/j1/position", ("cascade",)),
    )
    assert found["spring"].states == (ExportedValue("spring/j1/length", ("gauge",)),)
    assert [name for name in found if found[name].is_in_chained_mode] == ["spring"]


def test_a_dry_run_tells_order_and_modes(bench):
    load_chain(bench)

    result = bench.switch(start=["cascade"], strictness=Strictness.AUTO, dry_run=True)

    assert [info.name for info in result.plan.running] == ["cascade", "spring"]
    assert result.plan.chained == ("spring",)
    assert running(bench) == []


def test_a_set_point_in_the_first_cycle_of_a_chain_moves_all_of_it(bench):
    spring = bench.manager.get_controller("spring")
    bench.manager.register_loader(
        TableLoader({"test/Group": JointGroupPositionController})
    )
    group = bench.load_controller("group", "test/Group", joints=["spring/j1"])
    bench.switch(["spring", "group"])
    # Twice this is more than the start of an effort may jump.
    group.set_points.post([3.0])
    bench.step()
    assert spring.joint.get_command() == pytest.approx(6.0)
    assert bench.fault("spring") is None
    bench.switch([], ["group", "spring"])
    bench.switch(["spring"])
    spring.own = 3.0  # nobody has asked for this
    bench.step()
    assert "jump" in bench.fault("spring")
