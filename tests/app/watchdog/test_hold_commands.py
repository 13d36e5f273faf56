"""Commands that make the drivers of real arms hold."""

import sys

from station.app.watchdog.watch import HoldCommands
from tests.waiting import wait_until


def wait(holds, count, now=0.0):
    def are_there():
        holds.look(now)
        return len(holds.outcomes) >= count

    assert wait_until(are_there)


def test_every_command_is_run_and_its_end_is_kept(tmp_path):
    paths = [tmp_path / "left", tmp_path / "right"]
    holds = HoldCommands(tuple(("touch", str(path)) for path in paths))

    holds.start(0.0)
    wait(holds, 2)

    assert all(path.exists() for path in paths)
    assert {one["outcome"] for one in holds.outcomes} == {"ended with exit code 0"}


def test_a_command_that_does_not_exist_is_told_and_the_others_run(tmp_path):
    path = tmp_path / "held"
    holds = HoldCommands((("no-such-command-anywhere",), ("touch", str(path))))

    holds.start(0.0)
    wait(holds, 2)

    assert path.exists()
    assert "could not be started" in holds.outcomes[0]["outcome"]


def test_a_command_that_still_runs_is_not_started_twice_and_is_killed_in_the_end():
    sleep = (sys.executable, "-c", "import time; time.sleep(600)")
    holds = HoldCommands((sleep,))

    holds.start(0.0)
    holds.start(0.5)
    assert not holds.look(0.9)
    wait(holds, 1, now=1.1)

    assert [one["outcome"] for one in holds.outcomes] == ["ended with exit code -9"]
