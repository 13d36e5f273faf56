"""Exit codes, spellings, and errors with their remedy on stderr."""

import json
import subprocess
import sys

import pytest

from station.cli import main, normalise
from station.client import ApiError
from tests.waiting import PATIENCE

HEAVY = ("fastapi", "httpx", "mujoco", "numpy", "pydantic", "rich", "viser", "yaml")


@pytest.mark.parametrize(
    ("given", "wanted"),
    [
        (["list-controllers", "--json"], ["list_controllers", "--json"]),
        (["--version"], ["--version"]),
        (
            ["command", "arm", "-1e-3", "-.5", "-2."],
            ["command", "arm", "-0.001", "-0.5", "-2"],
        ),
        (["echo", "-n", "1"], ["echo", "-n", "1"]),
        (["load", "my-arm"], ["load", "my-arm"]),
        ([], []),
    ],
)
def test_arguments_are_normalised(given, wanted):
    assert normalise(given) == wanted


@pytest.mark.parametrize(
    "line", ["", "frobnicate", "run --port x", "gains arm", "command arm x"]
)
def test_wrong_usage_is_2(run, line):
    outcome = run(line)

    assert outcome.code == 2
    assert "usage:" in outcome.err


@pytest.mark.parametrize("line", ["--help", "--version", "run --help"])
def test_help_is_0(run, line):
    outcome = run(line)

    assert outcome.code == 0
    assert "station" in outcome.out


def test_refusal_is_1_with_its_reason_and_remedy(run, station):
    station.refusal = ApiError(
        "Controller 'x' is unknown.", status=404, code="not_found", remedy="Load it."
    )

    outcome = run("unload x")

    assert outcome.code == 1
    assert outcome.err == "error: Controller 'x' is unknown.\nLoad it.\n"
    assert outcome.out == ""


def test_refusal_can_be_json(run, station):
    station.refusal = ApiError("No.", status=409, code="conflict", remedy="Wait.")

    outcome = run("unload x --json")

    assert json.loads(outcome.err) == {
        "code": "conflict",
        "detail": "No.",
        "remedy": "Wait.",
    }


def test_defect_of_the_program_is_not_hidden(station):
    station.refusal = ZeroDivisionError()

    with pytest.raises(ZeroDivisionError):
        main(["unload", "x"])


def test_ctrl_c_ends_a_verb(station):
    station.refusal = KeyboardInterrupt()

    assert main(["unload", "x"]) == 130


def test_help_imports_nothing_heavy():
    program = (
        "import sys\nfrom station.cli import main\n"
        f"main(['--help'])\nprint(sorted(set(sys.modules) & {set(HEAVY)}))"
    )

    ended = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )

    assert ended.stdout.endswith("[]\n")


def test_reader_that_has_enough_is_no_error():
    program = (
        "import sys\nfrom station.cli import output\n"
        "from station.cli import main\n"
        "import station.cli.verbs.doctor as verb\n"
        "def endless(_):\n    while True:\n        output.say('x' * 1000)\n"
        "verb.doctor = endless\nsys.exit(main(['doctor']))\n"
    )
    station = subprocess.Popen(
        [sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    station.stdout.read(10)
    station.stdout.close()
    errors = station.stderr.read()
    station.stderr.close()

    assert (station.wait(PATIENCE), errors) == (0, b"")
