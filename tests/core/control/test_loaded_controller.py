"""What the manager keeps for a loaded controller."""

import pytest

from station.core.ports.goal import GoalPort, GoalStatus
from station.testing.scripted import ScriptedBench


@pytest.fixture
def bench():
    return ScriptedBench()


def test_the_status_says_everything_whatever_the_state(bench):
    bench.load("arm", "j1", "j2", fallback=["hold"])

    (status,) = bench.manager.list_controllers()

    assert (status.name, status.type) == ("arm", "test/Effort")
    assert status.state.value == "initialized"
    assert status.claimed_resources[0].resources == ("j1", "j2")
    assert status.fallback == ("hold",)
    assert status.time.count == 0


def test_statistics_count_updates_and_take_their_time(bench):
    bench.load("arm", "j1")
    bench.switch(["arm"])

    bench.step(5)

    (statistics,) = bench.manager.controller_statistics()
    assert statistics.running
    assert statistics.time.count == 5
    assert 0.0 < statistics.mean_time <= statistics.max_time
    assert statistics.variance_time >= 0.0
    assert statistics.timestamp == bench.time


def test_an_update_longer_than_the_period_is_an_overrun(bench):
    bench.load("arm", "j1")
    bench.switch(["arm"])

    bench.manager.update(bench.time + 1.0, 1e-9)

    (statistics,) = bench.manager.controller_statistics()
    assert statistics.num_control_loop_overruns == 1
    assert statistics.time_last_control_loop_overrun == bench.time + 1.0


def test_statistics_start_anew_on_request(bench):
    bench.load("arm", "j1")
    bench.switch(["arm"])
    bench.step(5)

    bench.manager.reset_statistics()

    (statistics,) = bench.manager.controller_statistics()
    assert statistics.time.count == 0
    assert statistics.mean_time == 0.0


class Port(GoalPort):
    """Takes every goal."""

    def submit(self, request, ticket=None):
        goal = self.new_goal(request)
        self.remember(goal)
        return goal


def fail():
    raise RuntimeError("broken gear")


@pytest.mark.parametrize("callback", ["update", "stopping"])
def test_the_goals_of_a_controller_that_fails_say_why(bench, callback):
    controller = bench.load("bad", "j1")
    controller.goals = Port()
    bench.switch(["bad"])
    goal = controller.goals.submit({})
    controller.actions[callback] = fail

    bench.step()
    if callback == "stopping":
        bench.switch(stop=["bad"])

    assert goal.status is GoalStatus.ABORTED
    assert goal.result.message.startswith(
        f"The controller failed: {callback} raised RuntimeError: broken gear"
    )
