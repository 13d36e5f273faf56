"""What the command line says about experiments that have ended."""

import json
from types import SimpleNamespace

import pytest

from station.cli import main
from station.client import ApiError
from station.trials.results import Results, file_of
from station.trials.trial import Script, Setup, Trial, TrialResult

GROUP = "effort_group_position_controller"
TRAJECTORY = "effort_joint_trajectory_controller"


@pytest.fixture
def hashes(tmp_path, monkeypatch):
    """Make the experiments `one` and `two`; return the hashes of `one`."""
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    base = Trial(Setup.load(), Script(controller=GROUP, duration=0.1))
    found = []
    plan = {"gains_before": {GROUP: {"panda_joint1/p": 600.0}}}
    for name in ("one", "two"):
        with Results.create(file_of(name), "sweep", base.setup, plan) as results:
            for factor in (0.5, 0.8, 0.9):
                trial = base.with_parameters({f"scale/{GROUP}/p": factor})
                metrics = {"rms_error": factor / 10.0, "effort_rms": 2.0}
                result = TrialResult(trial.hash, "done", None, metrics, 0.1, "w")
                results.add(trial, result)
                found.append(trial.hash)
    return found[:3]


def say(capsys, *words):
    assert main(["experiments", *words]) == 0
    return capsys.readouterr().out


def test_experiments_are_listed_and_shown(hashes, capsys):
    assert json.loads(say(capsys, "list", "--json")) == [
        {"name": "one", "kind": "sweep", "trials": 3},
        {"name": "two", "kind": "sweep", "trials": 3},
    ]
    assert "one         sweep  3" in say(capsys, "list")
    assert hashes[2] in say(capsys, "show", "one")
    assert len(json.loads(say(capsys, "show", "one", "--json"))) == 3


def test_best_trials_are_ranked(hashes, capsys):
    best = json.loads(say(capsys, "best", "one", "--count", "2", "--json"))

    assert [row["hash"] for row in best] == hashes[:2]
    assert f"{hashes[0]}  0.05       2" in say(capsys, "best", "one")


@pytest.mark.slow
@pytest.mark.usefixtures("hashes")
def test_results_are_exported_drawn_and_compared(capsys, tmp_path):
    say(capsys, "export", "one", str(tmp_path / "one.csv"))
    say(capsys, "plot", "one", str(tmp_path / "one.png"))

    assert (tmp_path / "one.csv").read_text().startswith("number,hash,state")
    assert (tmp_path / "one.png").stat().st_size > 1000
    compared = json.loads(say(capsys, "compare", "one", "two", "--json"))
    assert {c["metric"]: c["p_value"] for c in compared}["rms_error"] == 1.0
    assert "by chance alone" in say(capsys, "compare", "one", "two")


def test_a_trial_is_replayed_from_its_hash(hashes, capsys):
    """The numbers that are kept here are invented, so that the first replay differs."""
    assert main(["experiments", "replay", "one", hashes[0][:8], "--json"]) == 1
    found = json.loads(capsys.readouterr().out)
    assert (found["hash"], found["is_same"]) == (hashes[0], False)
    with Results.open(file_of("one")) as results:
        trial = results.trial(hashes[0])
        assert list(results.recordings()) == [hashes[0]]
    true = TrialResult(trial.hash, "done", None, found["metrics"], 0.1, "w")
    with Results.create(file_of("true"), "sweep", trial.setup, {}) as results:
        results.add(trial, true)

    assert "the same, bit for bit" in say(capsys, "replay", "true")


@pytest.mark.usefixtures("hashes")
def test_gains_are_written_to_a_file(capsys, tmp_path):
    say(capsys, "apply", "one", "--yaml", str(tmp_path / "gains.yaml"))

    assert "panda_joint1/p: 300.0" in (tmp_path / "gains.yaml").read_text()


@pytest.mark.parametrize(
    ("words", "reason", "code"),
    [
        (["show"], "too few or too many", 2),
        (["list", "one"], "too few or too many", 2),
        (["show", "three"], "There is no experiment 'three'", 1),
        (["apply", "one", "abc"], "no trial 'abc'", 1),
    ],
)
@pytest.mark.usefixtures("hashes")
def test_wrong_words_are_refused(capsys, words, reason, code):
    assert main(["experiments", *words]) == code
    assert reason in capsys.readouterr().err


class FakeGains:
    """A station that keeps gains, and may refuse to change them."""

    def __init__(self, *, refuses=False):
        self.calls = []
        self.gain_sets = SimpleNamespace(set_gains=self._set, save=self._save)
        self.refuses = refuses

    def __enter__(self):
        return self

    def __exit__(self, *_):
        return None

    def gains(self, _):
        return SimpleNamespace(revision=7, values={"panda_joint1/p": 600.0})

    def _set(self, changes, revisions):
        if self.refuses:
            raise ApiError("The gains have changed.", status=412, code="changed")
        self.calls.append((changes, revisions))

    def _save(self, name, controllers):
        self.calls.append((name, controllers))


@pytest.fixture
def use(monkeypatch):
    """Return a function that makes the verb talk to a fake."""

    def choose(fake):
        monkeypatch.setattr(
            "station.cli.verbs.experiment_results.open_client", lambda _: fake
        )
        return fake

    return choose


def test_apply_shows_first_and_sets_when_told_so(hashes, capsys, use):
    fake = use(FakeGains())

    shown = say(capsys, "apply", "one", hashes[1])
    assert "panda_joint1/p  600" in shown
    assert "Nothing has changed" in shown
    assert fake.calls == []

    shown = say(capsys, "apply", "one", hashes[1], "--yes")
    gains = {GROUP: {"panda_joint1/p": 480.0}}
    assert fake.calls == [(gains, {GROUP: 7}), ("one", [GROUP])]
    assert "`station gains undo` takes them back." in shown


@pytest.fixture
def both(tmp_path, monkeypatch):
    """Make the experiment `both`, whose trial changes gains of two controllers."""
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))
    base = Trial(Setup.load(), Script(controller=GROUP, duration=0.1))
    with Results.create(file_of("both"), "sweep", base.setup, {}) as results:
        gains = {f"gains/{name}/panda_joint1/p": 500.0 for name in (GROUP, TRAJECTORY)}
        trial = base.with_parameters(gains)
        results.add(
            trial, TrialResult(trial.hash, "done", None, {"rms_error": 1.0}, 0.1, "w")
        )


@pytest.mark.usefixtures("both")
def test_apply_sets_two_controllers_with_one_change_or_none(capsys, use):
    fake = use(FakeGains())
    say(capsys, "apply", "both", "--yes")
    changed = {name: {"panda_joint1/p": 500.0} for name in (GROUP, TRAJECTORY)}
    assert fake.calls[0] == (changed, {GROUP: 7, TRAJECTORY: 7})

    fake = use(FakeGains(refuses=True))
    assert main(["experiments", "apply", "both", "--yes"]) == 1
    assert fake.calls == []
    assert "The gains have changed." in capsys.readouterr().err


class FakeExperiments:
    """A station whose experiment is half done, and then done."""

    def __init__(self):
        self.experiments = self
        self.cancelled = []

    def __enter__(self):
        return self

    def __exit__(self, *_):
        return None

    def wait(self, name, watch):
        found = SimpleNamespace(
            name=name, ended=50, trials=100, cost=0.5, left=12.0, state="done"
        )
        watch(found)
        found.reason = "No trial was better in 15 generations."
        return found

    def cancel(self, name):
        self.cancelled.append(name)
        return SimpleNamespace(name=name, ended=50)


def test_an_experiment_of_the_station_is_watched_to_its_end(capsys, use):
    use(FakeExperiments())

    assert main(["experiments", "watch", "one"]) == 0

    out, err = capsys.readouterr()
    assert "one: done. No trial was better" in out
    assert "50 of at most 100 trials, best cost 0.500 of the first, 12 s left" in err


def test_an_experiment_of_the_station_is_cancelled(capsys, use):
    fake = use(FakeExperiments())

    assert "50 are kept" in say(capsys, "cancel", "one")
    assert fake.cancelled == ["one"]
