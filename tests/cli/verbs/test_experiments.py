"""The verbs of experiments, in this process and with few trials."""

import json
from types import SimpleNamespace

import pytest

from station.app.in_process import InProcessStation
from station.cli import main
from station.cli.parser import parse
from station.cli.verbs import experiments
from station.experiments.pools import InThisProcess
from station.trials.results import Results, file_of

GROUP = "effort_group_position_controller"
SCRIPT = f"""
controller: {GROUP}
duration: 0.15
commands: [{{kind: step, joint: panda_joint1, amplitude: 0.05, at: 0.01}}]
"""


@pytest.fixture(autouse=True)
def own_folder(tmp_path, monkeypatch):
    """Keep the experiments of each test apart."""
    monkeypatch.setenv("XDG_DATA_HOME", str(tmp_path))


@pytest.fixture
def script(tmp_path):
    """Write a script of 0.15 s."""
    path = tmp_path / "script.yaml"
    path.write_text(SCRIPT)
    return str(path)


@pytest.fixture
def run(capsys, script):
    """Return a function that runs a verb in this process and returns its JSON."""

    def call(verb, *words, code=0):
        extra = ("--script", script, "--workers", "0", "--name", "x", "--json")
        assert main([verb, GROUP, *words, *extra]) == code
        out = capsys.readouterr()
        return json.loads(out.out) if code == 0 else out.err

    return call


def test_sweep_runs_every_point_and_goes_on(run):
    found = run("sweep", "load=0:2:3", "--method", "grid")

    assert (found["ended"], found["failed"]) == (3, 0)
    assert found["metrics"]["rms_error"]["worst"] > 0.0
    run("sweep", "load=0:2:3", "--method", "grid")
    with Results.open(file_of("x")) as results:
        assert results.count() == 3
        assert {row.parameters["load"] for row in results.rows()} == {0.0, 1.0, 2.0}


def test_another_sweep_of_the_same_name_is_refused(run):
    run("sweep", "load=0:2:1", "--method", "grid")

    error = run("sweep", "load=0:2:2", "--method", "grid", code=1)

    assert "'x' exists, and is another one" in error


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (["weight=0:1"], "no parameter 'weight'"),
        (["load=2:1"], "is empty"),
        (["load=0:1", "--with", "load"], "is not NAME=VALUE"),
        (["load=0:1", "--with", "mass=1"], "no parameter 'mass'"),
        (["friction/panda_joint9=0:1"], "no joint 'panda_joint9'"),
        (["load=0:1", "--with", "damping/joint=1"], "no joint 'joint'"),
        ([f"gains/{GROUP}/panda_joint1/q=0:1"], "no gain 'panda_joint1/q'"),
        (["load=0:1", "--cluster", "127.0.0.1"], "is no address of a scheduler"),
    ],
)
def test_impossible_sweep_is_refused_and_leaves_nothing(run, words, reason):
    code = 2 if "NAME=VALUE" in reason else 1

    assert reason in run("sweep", *words, code=code)
    assert not file_of("x").exists()


def test_impossible_search_is_refused_and_leaves_nothing(run):
    assert "A search of 1 trials" in run("tune", "--trials", "1", code=1)
    assert main(["sweep", GROUP, "load=0:1", "--workers", "-1", "--name", "x"]) == 1
    assert not file_of("x").exists()


@pytest.mark.parametrize(
    ("verb", "words"),
    [
        ("tune", ["--at-most", "settling_time=0.5"]),
        ("tune", ["--weight", "overshoot=1"]),
        ("sweep", ["load=0:1", "--metric", "rise_time"]),
    ],
)
def test_metric_that_the_script_cannot_have_is_refused(capsys, verb, words):
    """Without a script, all joints move, and no joint by a step."""
    assert main([verb, GROUP, *words, "--workers", "0", "--name", "x"]) == 1

    assert "that is one of a single step" in capsys.readouterr().err
    assert not file_of("x").exists()


def test_trials_that_fail_are_told_with_all_of_their_reason(script, capsys):
    """The others go on; without any trial that is done the exit code is 1."""
    gain = f"gains/{GROUP}/panda_joint1/p"
    words = ("--script", script, "--workers", "0", "--method", "grid")

    assert main(["sweep", GROUP, f"{gain}=600,1e9,2e9", *words, "--name", "a"]) == 0
    out = capsys.readouterr().out
    assert "3 trials, 2 failed." in out
    assert "is 1000000000.0; allowed is 0.0 to 10000.0 Nm/rad" in out
    assert main(["sweep", GROUP, f"{gain}=1e9", "load=0,1", *words, "--name", "b"]) == 1
    assert " and 1 more: Gain 'panda_joint1/p' is 1000" in capsys.readouterr().out


def test_script_of_another_controller_is_refused(script, capsys):
    words = ["sweep", "position_group_controller", "load=0:1", "--script", script]

    assert main(words) == 2
    assert (
        "is a script of 'effort_group_position_controller'" in capsys.readouterr().err
    )


def test_recording_without_the_controller_is_refused_by_name(tmp_path, capsys):
    """What a recording becomes is tested with `station.experiments.recordings`."""
    with InProcessStation() as station, station.record(tmp_path) as path:
        station.step(5)
    words = ["sweep", GROUP, "load=0:1", "--script", str(path)]

    assert main(words) == 1
    assert f"'{GROUP}' had no set-points in {path}" in capsys.readouterr().err


def test_robustness_keeps_its_worst_trials(run):
    found = run("robustness", "--trials", "3", "--keep-worst", "1")

    assert found["ended"] == 3
    with Results.open(file_of("x")) as results:
        assert results.kind == "robustness"
        assert list(results.recordings()) == [
            max(results.rows(), key=lambda r: r.result.metrics["rms_error"]).result.hash
        ]
        assert len({row.seed for row in results.rows()}) == 3


def test_tune_begins_with_the_gains_of_its_start(run):
    found = run(
        *("tune", "--trials", "13", "--gains", "p"),
        *("--with", f"scale/{GROUP}/p=0.2", "--at-most", "effort_rms=1.2x"),
    )

    with Results.open(file_of("x")) as results:
        first = results.trial(results.plan["first"])
    assert first.parameters[f"gains/{GROUP}/panda_joint1/p"] == pytest.approx(40.0)
    assert found["cost"] <= 1.0
    assert set(found["gains"]) == set(first.parameters)


class Interrupted(InThisProcess):
    """Is interrupted by Ctrl-C at one of its tasks.

    Args:
        task: The number of the task.

    Attributes:
        trials: How many trials the tasks before had.
    """

    def __init__(self, task):
        self.task = task
        self.trials = 0

    def submit(self, fn, /, *args, **kwargs):
        self.task -= 1
        if self.task == 0:
            raise KeyboardInterrupt
        self.trials += len(args[1])
        return super().submit(fn, *args, **kwargs)


@pytest.mark.parametrize(("verb", "task"), [("tune", 1), ("tune", 5), ("sweep", 2)])
def test_ctrl_c_says_how_to_go_on(monkeypatch, script, capsys, verb, task):
    executor = Interrupted(task)
    monkeypatch.setattr("station.experiments.pools.make_pool", lambda _: executor)
    words = [] if verb == "tune" else ["load=0:1"]

    code = main([verb, GROUP, *words, "--trials", "20", "--script", script, "--name=x"])

    assert code == 130
    told = capsys.readouterr().err
    assert executor.trials >= task - 1
    assert (
        f"{executor.trials} trials are kept. Repeat the command with --name x" in told
    )
    with Results.open(file_of("x")) as results:
        assert results.count() == executor.trials
        assert results.outcome()[0] == "cancelled"


class StationWithBelt:
    """A station that has loaded the controller `belt`, which no configuration has."""

    def __enter__(self):
        return self

    def __exit__(self, *_):
        return None

    def gains(self, controller):
        assert controller == "belt"
        return SimpleNamespace(values={f"panda_joint{n}/p": 30.0 for n in range(1, 8)})

    def parameter(self, path):
        assert path == "belt"
        joints = [f"panda_joint{n}" for n in range(1, 8)]
        gains = {joint: {"pid": {"p": 60.0, "d": 5.0}} for joint in joints}
        kind = "effort_controllers/JointGroupPositionController"
        return {"type": kind, "joints": joints, **gains}


def test_a_controller_that_a_station_has_loaded_is_tuned_live(
    monkeypatch, tmp_path, capsys
):
    monkeypatch.setattr(
        "station.cli.verbs.experiments.open_client", lambda _: StationWithBelt()
    )
    script = tmp_path / "belt.yaml"
    script.write_text(SCRIPT.replace(GROUP, "belt"))
    words = ["--live", "--trials", "2", "--gains", "p", "--workers", "0", "--json"]

    code = main(["tune", "belt", *words, "--script", str(script), "--name", "x"])

    assert code == 0, capsys.readouterr().err
    found = json.loads(capsys.readouterr().out)
    assert found["gains"] == {f"gains/belt/panda_joint{n}/p": 30 for n in range(1, 8)}


class FakeStation:
    """A station that keeps what it is asked to start."""

    def __init__(self):
        self.experiments = self
        self.requests = []

    def __enter__(self):
        return self

    def __exit__(self, *_):
        return None

    def start(self, request):
        self.requests.append(request)
        return SimpleNamespace(name="x", model_dump=lambda: {"name": "x"})


def test_background_hands_the_experiment_to_the_station(monkeypatch, script):
    fake = FakeStation()
    monkeypatch.setattr("station.cli.verbs.experiments.open_client", lambda _: fake)
    words = ["tune", GROUP, "--background", "--trials", "20", "--script", script]
    assert main([*words, "--at-most", "effort_peak=1.5x"]) == 0

    (request,) = fake.requests
    assert (request.kind, request.trials, request.duration) == ("tune", 20, 0.15)
    assert request.commands[0].joint == "panda_joint1"
    assert request.bounds[0].is_relative
    assert main([*words, "--cluster", "tcp://localhost:8786"]) == 2


def test_ranges_and_options_of_a_sweep():
    options = parse([
        *("sweep", "arm", "load=0:3", "delay=0,1", "--trials", "5"),
        *("--with", "friction=1", "--cluster", "tcp://here:8786"),
    ])

    assert (options.controller, options.ranges) == ("arm", ["load=0:3", "delay=0,1"])
    assert (options.trials, options.cluster) == (5, "tcp://here:8786")
    assert options.run is experiments.sweep


@pytest.mark.parametrize(
    "words",
    [["sweep", "arm"], ["tune"], ["experiments", "bake"], ["validate"], ["identify"]],
)
def test_missing_and_unknown_words_are_refused(words, capsys):
    with pytest.raises(SystemExit):
        parse(words)
    assert capsys.readouterr().err
