"""A loaded controller out of a name and its parameters."""

import threading

import pytest

from station.core.control.controller import MultiInterfaceController
from station.core.control.controller_factory import COMMON_PARAMETERS, ControllerFactory
from station.core.control.controller_loader import TableLoader
from station.core.declared_parameter import DeclaredParameter, ParameterType
from station.core.errors import (
    ControllerExistsError,
    ControllerLoadError,
    ControllerTypeNotFoundError,
    ParameterError,
)
from station.core.hardware.robot_hw import RobotHW
from station.core.parameters import Parameters
from station.hw.mock import MockRobotHW
from station.testing.scripted import TYPES, Scripted, ScriptedBench
from tests.waiting import PATIENCE

GAIN = DeclaredParameter(
    name="gain", type=ParameterType.NUMBER, default=1.0, description="pull"
)
EFFORT = "hardware_interface::EffortJointInterface"


@pytest.fixture
def parameters():
    return Parameters()


@pytest.fixture
def factory(parameters):
    robot = MockRobotHW()
    robot.init(parameters, parameters.namespace("hw"))
    return ControllerFactory(robot, parameters, [TableLoader(TYPES)])


def test_it_knows_what_the_controller_claims_and_may_command(factory, parameters):
    parameters.set("arm", {"type": "test/Effort", "joints": ["joint2", "joint1"]})

    loaded = factory.build("arm")

    (claim,) = loaded.info.claimed_resources
    assert claim.hardware_interface == EFFORT
    assert claim.resources == ("joint1", "joint2")
    assert [guard.name for guard in loaded.commands.guards] == ["joint1", "joint2"]
    assert loaded.controller.state.value == "initialized"


@pytest.mark.parametrize("name", ["~bad", "bad name", "", "a//b", "/a", "a/"])
def test_a_name_that_is_none_is_refused(factory, name):
    with pytest.raises(ControllerLoadError, match="no name"):
        factory.build(name)


def test_a_controller_is_no_fallback_of_itself(factory, parameters):
    arm = {"type": "test/Effort", "joints": ["joint1"], "fallback": ["rest", "arm"]}
    parameters.set("arm", arm)

    with pytest.raises(ParameterError, match=r"'arm'\]; it must be names of other con"):
        factory.build("arm")


@pytest.mark.parametrize("cycles", [0, 1.5])
def test_results_count_after_whole_cycles(factory, parameters, cycles):
    wanted = {"is_async": True, "async_parameters": {"cycles": cycles}}
    parameters.set("arm", {"type": "test/Effort", "joints": ["joint1"], **wanted})

    with pytest.raises(ParameterError, match=rf"cycles' is {cycles:.1f}; it must be "):
        factory.build("arm")


@pytest.mark.parametrize("name", ["1bad", "a/b", "never_defined"])
def test_a_controller_without_a_type_is_refused(factory, name):
    with pytest.raises(ParameterError, match=f"{name}/type"):
        factory.build(name)


def test_a_type_that_is_no_string_is_refused(factory, parameters):
    parameters.set("arm/type", 3)

    with pytest.raises(ParameterError, match="arm/type"):
        factory.build("arm")


def test_an_unknown_type_is_refused(factory, parameters):
    parameters.set("arm/type", "test/Nope")

    with pytest.raises(ControllerTypeNotFoundError, match="test/Nope"):
        factory.build("arm")


def test_a_joint_the_robot_does_not_have_is_refused_by_name(factory, parameters):
    parameters.set("arm", {"type": "test/Effort", "joints": ["elbow"]})

    with pytest.raises(ControllerLoadError, match=r"'arm'.*'elbow'") as caught:
        factory.build("arm")

    assert caught.value.details["cause"] == "resource_not_found"
    assert "joint1" in caught.value.remedy


def test_a_missing_interface_is_refused_by_name(parameters):
    parameters.set("arm", {"type": "test/Effort"})
    factory = ControllerFactory(RobotHW(), parameters, [TableLoader(TYPES)])

    with pytest.raises(ControllerLoadError, match="EffortJointInterface"):
        factory.build("arm")


def test_an_exception_of_init_is_refused_with_its_traceback(factory, parameters):
    parameters.set("arm", {"type": "test/Effort", "init_raises": "no power"})

    with pytest.raises(ControllerLoadError, match="RuntimeError: no power") as caught:
        factory.build("arm")

    assert "Traceback" in str(caught.value.details["traceback"])


def test_an_init_that_exits_is_refused_and_ends_nothing(factory, parameters):
    class Leaving(MultiInterfaceController):
        def init(self, hw, params):
            raise SystemExit(5)

    factory.loaders.append(TableLoader({"test/Leaving": Leaving}))
    parameters.set("arm", {"type": "test/Leaving"})

    with pytest.raises(ControllerLoadError, match="SystemExit: 5"):
        factory.build("arm")


def test_claims_of_a_failed_init_do_not_stick_to_the_next(factory, parameters):
    parameters.set(
        "bad", {"type": "test/Effort", "joints": ["joint1"], "init_raises": "x"}
    )
    parameters.set("good", {"type": "test/Effort", "joints": ["joint2"]})
    with pytest.raises(ControllerLoadError):
        factory.build("bad")

    (claim,) = factory.build("good").info.claimed_resources

    assert claim.resources == ("joint2",)


class Declaring(MultiInterfaceController):
    """Pulls.

    The rest of the docstring is not shown.
    """

    @classmethod
    def declared_parameters(cls):
        return (GAIN,)


class Careless(MultiInterfaceController):
    """Cannot say what it reads."""

    @classmethod
    def declared_parameters(cls):
        raise RuntimeError("never thought of it")


def types_of(parameters, table):
    factory = ControllerFactory(MockRobotHW(), parameters, [TableLoader(table)])
    return factory.describe_types()


def test_a_type_is_described_by_its_docstring_and_its_parameters(parameters):
    (found,) = types_of(parameters, {"a/Declaring": Declaring})

    assert (found.type, found.description) == ("a/Declaring", "Pulls.")
    names = [one.name for one in found.parameters]
    assert names == [*(one.name for one in COMMON_PARAMETERS), "gain"]
    assert found.error is None


@pytest.mark.parametrize(
    ("target", "cause"),
    [(Careless, "never thought of it"), ("no_such_module:X", "no_such_module")],
)
def test_a_type_that_cannot_be_described_is_listed_with_the_cause(
    parameters, target, cause
):
    broken, sound = types_of(parameters, {"a/Broken": target, "a/Sound": Declaring})

    assert cause in broken.error
    assert broken.parameters == ()
    assert sound.error is None


class Picky(MultiInterfaceController):
    """Knows its parameters, one of which it reads without a declaration."""

    accepted_parameters = ("old",)

    @classmethod
    def declared_parameters(cls):
        return (GAIN, GAIN.inside("<joint>"))

    def init(self, hw, params):
        self.joint_names = ["elbow"]
        params.get_float("undeclared", 0.0)


class Careless(MultiInterfaceController):
    """Says nothing of its parameters."""

    def update(self, time, period):
        print(time)  # noqa: T201 - what is told


KNOWN = {
    "gain": 2.0,
    "elbow": {"gain": 3.0},
    "undeclared": 1.0,
    "old": 1,
    "fallback": [],
    "allow_start_jump": True,
}


@pytest.fixture
def picky(factory, parameters):
    factory.loaders.append(TableLoader({"a/Picky": Picky, "a/Careless": Careless}))
    parameters.set("arm", {"type": "a/Picky", **KNOWN})
    return parameters


@pytest.mark.usefixtures("picky")
def test_parameters_that_a_type_knows_are_taken_silently(factory):
    assert factory.build("arm", strict=True).status().notes == ()


@pytest.mark.parametrize(
    ("path", "nearest"),
    [("gian", "gain"), ("elbow/gani", "gain"), ("fallbak", "fallback")],
)
def test_a_parameter_that_nobody_knows_is_refused_or_told(
    factory, picky, path, nearest
):
    picky.set(f"arm/{path}", 1.0)

    with pytest.raises(ParameterError, match=f"no parameter '{path}'") as caught:
        factory.build("arm", strict=True)
    assert nearest in str(caught.value).partition(f"'{path}'")[2]
    assert caught.value.details["parameters"] == [path]

    (note,) = factory.build("arm").status().notes
    assert f"'{path}' is unknown and has no effect" in note
    assert nearest in note


def test_types_that_declare_nothing_are_told_and_not_refused(factory, picky):
    picky.set("arm", {"type": "a/Careless", "gain": 1.0})
    unknown, printing = factory.build("arm", strict=True).status().notes
    assert "'gain' is unknown" in unknown
    assert "calls print" in printing


class Slow(Scripted):
    """Its init waits until the test lets it go on."""

    reached = threading.Event()
    go_on = threading.Event()

    def init(self, interface, params):
        Slow.reached.set()
        Slow.go_on.wait(PATIENCE)
        super().init(interface, params)


@pytest.fixture
def bench():
    return ScriptedBench()


@pytest.fixture
def slow(bench):
    """Load `slow` in a thread; return what became of it once it is let go."""
    Slow.reached.clear()
    Slow.go_on.clear()
    bench.manager.register_loader(TableLoader({"test/Slow": Slow}))
    bench.parameters.set("slow", {"type": "test/Slow", "joints": ["j1"]})
    outcome = []

    def load(timeout=PATIENCE):
        try:
            bench.manager.load_controller("slow", timeout)
        except ControllerLoadError as error:
            outcome.append(error)

    thread = threading.Thread(target=load)
    thread.start()
    assert Slow.reached.wait(PATIENCE)
    yield outcome, thread
    Slow.go_on.set()
    thread.join(PATIENCE)
    for one in threading.enumerate():
        if one.name == "load slow":
            one.join(PATIENCE)


def names(bench):
    return {one.name: one.state.value for one in bench.manager.list_controllers()}


@pytest.mark.usefixtures("slow")
def test_a_controller_that_is_being_loaded_is_listed_as_loading(bench):
    assert names(bench) == {"slow": "loading"}


@pytest.mark.usefixtures("slow")
def test_loading_holds_nobody_else_up(bench):
    bench.load("arm", "j1")
    assert bench.switch(["arm"]).ok
    assert bench.switch(stop=["arm"]).ok
    bench.manager.unload_controller("arm")

    assert names(bench) == {"slow": "loading"}


def test_the_claims_of_a_slow_init_are_its_own(bench, slow):
    bench.load("arm", "j2", "j3")
    Slow.go_on.set()
    slow[1].join(PATIENCE)

    claims = {
        one.name: one.claimed_resources[0].resources
        for one in bench.manager.list_controllers()
    }
    assert claims == {"arm": ("j2", "j3"), "slow": ("j1",)}


@pytest.mark.usefixtures("slow")
def test_a_name_is_loaded_once_at_a_time(bench):
    with pytest.raises(ControllerExistsError, match="'slow' is being loaded"):
        bench.manager.load_controller("slow")


def test_unloading_gives_a_loading_controller_up(bench, slow):
    outcome, thread = slow

    bench.manager.unload_controller("slow")
    thread.join(PATIENCE)

    assert "was cancelled" in outcome[0].message
    assert names(bench) == {}


def test_what_a_given_up_init_returns_later_is_thrown_away(bench, slow):
    bench.manager.unload_controller("slow")
    Slow.go_on.set()
    slow[1].join(PATIENCE)

    assert names(bench) == {}
    bench.load("slow", "j1")
    assert names(bench) == {"slow": "initialized"}


def test_a_loading_that_ends_leaves_the_next_one_of_its_name_alone(bench):
    bench.load("arm", "j1")
    bench.manager.unload_controller("arm")
    first = bench.manager.announce("arm")
    bench.manager.finish_loading(first.__enter__())
    bench.manager.unload_controller("arm")

    with bench.manager.announce("arm"):
        first.__exit__(None, None, None)

        assert names(bench) == {"arm": "loading"}
    assert names(bench) == {}


def test_a_hanging_init_ends_at_its_deadline(bench):
    Slow.reached.clear()
    Slow.go_on.clear()
    bench.manager.register_loader(TableLoader({"test/Slow": Slow}))
    bench.parameters.set("slow", {"type": "test/Slow", "joints": ["j1"]})

    with pytest.raises(ControllerLoadError, match=r"not loaded within 0\.01 s"):
        bench.manager.load_controller("slow", timeout=0.01)

    assert names(bench) == {}
    Slow.go_on.set()
    for thread in threading.enumerate():
        if thread.name == "load slow":
            thread.join(PATIENCE)


def test_an_init_may_ask_the_manager(bench):
    class Curious(Scripted):
        """Asks who is there, and loads another controller."""

        def init(self, interface, params):
            super().init(interface, params)
            bench.load("helper", "j2")
            self.seen = names(bench)

    bench.manager.register_loader(TableLoader({"test/Curious": Curious}))
    bench.parameters.set("curious", {"type": "test/Curious", "joints": ["j1"]})

    bench.manager.load_controller("curious")

    seen = bench.manager.get_controller("curious").seen
    assert seen == {"helper": "initialized", "curious": "loading"}
