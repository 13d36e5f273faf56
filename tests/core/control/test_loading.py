"""Foreign code that imports, constructs or initialises a controller holds nobody up."""

import threading

import pytest

from station.core.control.controller_loader import TableLoader
from station.core.errors import (
    ControllerExistsError,
    ControllerLoadError,
)
from station.testing.scripted import Scripted, ScriptedBench
from tests.waiting import PATIENCE


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
