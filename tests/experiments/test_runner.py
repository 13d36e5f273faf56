"""Trials are handed to an executor, and each that ends is kept once."""

import json
from concurrent.futures import Executor, Future
from concurrent.futures.process import BrokenProcessPool

import pytest

from station.experiments.pools import InThisProcess, compare, identity, make_pool
from station.experiments.runner import Runner
from station.trials.errors import ExperimentError, WorkerMismatchError
from station.trials.results import Results
from station.trials.trial import Script, Setup, Trial

LOADS = [0.0, 0.5, 1.0]


@pytest.fixture
def results(tmp_path, panda):
    with Results.create(tmp_path / "runs.sqlite", "sweep", panda, {}) as opened:
        yield opened


@pytest.fixture
def trials(step):
    return [step.with_parameters({"load": load}) for load in LOADS]


def test_every_trial_is_kept_and_watched(results, trials):
    seen = []
    runner = Runner(results, InThisProcess(), lambda p: seen.append(p.ended))

    progress = runner.run(trials, len(trials))

    assert seen == [1, 2, 3]
    assert (progress.failed, progress.resumed) == (0, 0)
    assert [row.parameters["load"] for row in results.rows()] == LOADS


def test_failed_trial_is_counted_and_the_others_go_on(results, trials):
    trials.insert(1, trials[0].with_parameters({"weight": 1.0}))

    progress = Runner(results, InThisProcess()).run(trials, len(trials))

    assert (progress.ended, progress.failed) == (4, 1)
    assert "no parameter 'weight'" in results.find(trials[1].hash).reason


def test_trials_that_have_ended_are_not_run_again(results, trials):
    Runner(results, InThisProcess()).run(trials[:2], 2)
    counting = Counting()

    progress = Runner(results, counting).run(trials, 3)

    assert counting.submitted == 1
    assert (progress.ended, progress.resumed) == (3, 2)


class Counting(InThisProcess):
    """Counts what is submitted."""

    submitted = 0

    def submit(self, fn, /, *args, **kwargs):
        self.submitted += 1
        return super().submit(fn, *args, **kwargs)


class Losing(Counting):
    """Loses the worker of the first trials, or refuses as another version would."""

    losses = 2

    def submit(self, fn, /, *args, **kwargs):
        if self.submitted >= self.losses:
            return super().submit(fn, *args, **kwargs)
        self.submitted += 1
        future = Future()
        future.set_exception(WorkerMismatchError("Worker x has mujoco 1; not 4."))
        return future


def test_trial_of_a_worker_that_refuses_is_repeated_and_counted_once(results, trials):
    waits = []
    runner = Runner(results, Losing(), sleep=waits.append)
    progress = runner.run(trials, 3)

    assert waits == [0.1, 0.1]

    assert progress.repeated == 2
    assert progress.refused == ["Worker x has mujoco 1; not 4."]
    assert len(results.rows()) == progress.ended == 3


def test_generations_of_a_search_are_counted_together(results, trials):
    runner = Runner(results, Losing(), sleep=lambda _: None)
    runner.run([trials[0], trials[0].with_parameters({"weight": 1.0})], 2)

    progress = runner.run(trials, 3)

    assert (progress.repeated, progress.failed, progress.resumed) == (2, 1, 1)
    assert progress.refused == ["Worker x has mujoco 1; not 4."]
    assert progress.ended == 3


def test_workers_that_refuse_for_ever_end_the_run(results, trials):
    losing = Losing()
    losing.losses = 100

    with pytest.raises(ExperimentError, match="given away 5 times: Worker x has"):
        Runner(results, losing, sleep=lambda _: None).run(trials[:1], 1)


class Dying(InThisProcess):
    """Has processes that some trials kill; all that are in hand die with them.

    Args:
        deaths: How often the trial with each load kills its process.
    """

    _max_workers = 2

    def __init__(self, deaths):
        self.deaths = deaths

    def submit(self, fn, /, *args, **kwargs):
        load = json.loads(args[1][0])["parameters"]["load"]
        if self.deaths.get(load, 0) > 0:
            self.deaths[load] -= 1
            future = Future()
            future.set_exception(BrokenProcessPool("A child process terminated."))
            return future
        return super().submit(fn, *args, **kwargs)


def test_trial_that_was_lost_is_repeated_once(results, trials):
    progress = Runner(results, Dying({0.5: 1})).run(trials, 3)

    assert (progress.ended, progress.failed, progress.repeated) == (3, 0, 1)
    assert {row.parameters["load"] for row in results.rows()} == set(LOADS)


def test_trial_that_kills_its_process_twice_fails_by_name(results, trials):
    progress = Runner(results, Dying({0.0: 2, 0.5: 1})).run(trials, 3)

    assert (progress.ended, progress.failed, progress.repeated) == (3, 1, 2)
    lost = results.find(trials[0].hash)
    assert lost.state == "failed"
    assert lost.reason.startswith("Its process died, and once more")
    assert results.find(trials[1].hash).state == "done"


def test_first_trials_that_are_all_lost_do_not_end_the_run(results, trials):
    dying = Dying({0.0: 3, 0.5: 1, 1.0: 1})

    progress = Runner(results, dying).run(trials, 3)

    assert (progress.ended, progress.failed) == (3, 1)
    assert results.find(trials[0].hash).state == "failed"


def test_machine_on_which_every_process_dies_ends_the_run(results, trials):
    dying = Dying(dict.fromkeys(LOADS, 100))

    with pytest.raises(ExperimentError, match="die again and again, last with trial"):
        Runner(results, dying).run(trials, 3)
    assert results.count() == 0


class Refusing(InThisProcess):
    """Has refused a worker when it was asked for the second trial."""

    def __init__(self):
        self.refused = {}
        self.submitted = 0

    def submit(self, fn, /, *args, **kwargs):
        self.submitted += 1
        if self.submitted == 2:
            self.refused["tcp://x:1"] = "Worker x has mujoco 1; not 4."
        return super().submit(fn, *args, **kwargs)


def test_worker_that_the_executor_refuses_is_told(results, trials):
    told = []

    progress = Runner(results, Refusing(), lambda p: told.append(len(p.refused))).run(
        trials, 3
    )

    assert progress.refused == ["Worker x has mujoco 1; not 4."]
    assert told[0] == 1


class Interrupting(Executor):
    """Is interrupted by Ctrl-C while the second trial runs."""

    def __init__(self):
        self.inner = InThisProcess()
        self.count = 0

    def submit(self, fn, /, *args, **kwargs):
        self.count += 1
        if self.count == 2:
            raise KeyboardInterrupt
        return self.inner.submit(fn, *args, **kwargs)


def test_ctrl_c_keeps_what_is_done(results, trials):
    told = []
    runner = Runner(results, Interrupting(), lambda p: told.append(p.is_interrupted))

    progress = runner.run(trials, 3)

    assert progress.is_interrupted
    assert told[-1]
    assert [row.parameters["load"] for row in results.rows()] == LOADS[:1]


def test_worker_with_another_setup_is_refused(panda):
    other = Setup.load(settings={"station.rate": 500})

    with pytest.raises(WorkerMismatchError, match="Worker w has setup"):
        compare(identity(panda.text), identity(other.text), "w")
    assert identity(panda.text) == identity(panda.text)


def test_impossible_setup_is_refused_before_any_trial(tmp_path):
    mock = Setup.load({"robot": {"type": "mock_hw/MockRobotHW", "joints": ["a"]}})
    trial = Trial(mock, Script(controller="arm", duration=0.1))
    with Results.create(tmp_path / "mock.sqlite", "sweep", mock, {}) as opened:
        runner = Runner(opened, InThisProcess())
        with pytest.raises(ExperimentError, match="is not simulated"):
            runner.run([trial], 1)


@pytest.mark.slow
def test_processes_give_the_same_numbers(results, trials, world):
    with make_pool(2) as pool:
        Runner(results, pool).run(trials, 3)

    for trial in trials:
        assert results.find(trial.hash).metrics == world.run(trial).metrics
    assert {row.result.worker for row in results.rows()}


class Tasks(InThisProcess):
    """Notes how many trials are in each task."""

    worker_count = 2

    def __init__(self):
        self.sizes = []

    def submit(self, fn, /, *args, **kwargs):
        self.sizes.append(len(args[1]))
        return super().submit(fn, *args, **kwargs)


def quick_trials(step, count):
    script = step.script.model_copy(update={"duration": 0.02})
    short = Trial(step.setup, script)
    return [short.with_parameters({"load": n / 1000}) for n in range(count)]


def test_short_trials_travel_together_and_the_last_ones_are_spread(results, step):
    tasks = Tasks()
    progress = Runner(results, tasks).run(quick_trials(step, 60), 60)

    assert progress.ended == len(results.rows()) == sum(tasks.sizes) == 60
    # How long they take is not known at first; 8 tasks are in hand.
    assert tasks.sizes[:8] == [1] * 8
    assert max(tasks.sizes) > 1
    assert tasks.sizes[-1] == 1


def test_generation_of_a_large_search_is_spread_over_all_workers(results, step):
    runner = Runner(results, tasks := Tasks())
    runner.run(quick_trials(step, 2), 1000)

    runner.run(quick_trials(step, 8), 1000)

    assert tasks.sizes == [1] * 8
