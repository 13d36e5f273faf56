"""What a station tells its watchdog, and what it makes of the watchdog's end."""

import asyncio
import os

import pytest

from station.api.auth import Authenticator
from station.api.named_tokens import NamedTokens
from station.app.station_watchdog import EndedByWatchdogError, StationWatchdog
from station.config import load_config
from station.core.errors import LoopError
from station.core.loop.heartbeat import Heartbeat, Phase
from tests.two_joint_station import make_station


@pytest.fixture(autouse=True)
def directory(tmp_path, monkeypatch):
    """Let the runtime files be in a directory of the test."""
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))


class FakeProcess:
    """A watchdog's process that keeps what it is told, and ends when it is told to."""

    def __init__(self):
        self.settings, self.statuses, self.codes = [], [], []
        self.tokens = []
        self.last_look = None
        self.kills = 0
        self.heartbeat = Heartbeat()

    def finish(self, timeout):
        pass

    def start(self, settings):
        self.settings.append(settings)

    change = start

    def tell(self, status):
        self.statuses.append(status)

    def tell_token(self, token):
        self.tokens.append((token["role"], token["expires"]))

    def age(self, now):
        return 0.0 if self.last_look is None else now - self.last_look

    def kill(self):
        self.kills += 1
        self.codes.append(-9)

    def start_again_if_ended(self):
        return self.codes.pop(0) if self.codes else None


@pytest.fixture
def warnings():
    """Return the list of what was warned of."""
    return []


@pytest.fixture
def process():
    """Return the process of the watchdog."""
    return FakeProcess()


@pytest.fixture
def watchdog(warnings, process):
    """Return the watchdog of a station, with a process of the test."""
    return StationWatchdog(load_config(), warnings.append, process)


def test_settings_name_the_process_and_its_tokens(watchdog, process):
    authenticator = Authenticator("operator-token")
    watchdog.start(authenticator)

    (settings,) = process.settings
    assert settings.pid == os.getpid()
    assert settings.operator_token == "operator-token"
    assert settings.viewer_token == authenticator.viewer_token
    assert (settings.notice_after, settings.end_after) == (0.08, 10.0)


def test_a_slow_loop_may_use_its_period(warnings, process):
    config = load_config(flags={"station.rate": 5.0})
    watchdog = StationWatchdog(config, warnings.append, process)

    watchdog.start(Authenticator(None))

    assert process.settings[0].notice_after == 0.4


def test_steps_of_the_start_are_announced(watchdog, process):
    watchdog.announce("Loading the controller 'arm'")

    assert process.statuses == [{"step": "Loading the controller 'arm'"}]


def test_guarding_begins_with_the_hold_commands_of_the_robot(
    watchdog, monkeypatch, process
):
    station = make_station()
    monkeypatch.setattr(station.loop.hw, "hold_commands", lambda: [["hold", "left"]])
    station.loop.step()
    watchdog.start(Authenticator(None))
    assert watchdog.heartbeat.phase is Phase.STARTING

    watchdog.guard(station)

    assert process.settings[-1].hold_commands == (("hold", "left"),)
    assert watchdog.heartbeat.phase is Phase.RUNNING
    (status,) = process.statuses
    assert (status["cycle"], status["running"]) == (1, "")
    assert status["positions"] == {"j1": 0.0, "j2": 0.0}


def test_an_ended_watchdog_makes_the_station_not_ready_until_it_runs_again(
    watchdog, warnings, process
):
    station = make_station()
    station.loop.step()
    process.codes = [-9, None]

    watchdog.look(station)
    assert station.watchdog_failure == "The watchdog ended (exit code -9)."
    watchdog.look(station)  # too soon for another start
    assert station.watchdog_failure is not None
    station.loop.clock.advance(1.1)
    watchdog.look(station)

    assert station.watchdog_failure is None
    assert warnings == ["The watchdog ended (exit code -9). It is started again."]


def test_a_suspended_watchdog_makes_the_station_not_ready_and_is_replaced(
    watchdog, warnings, process
):
    station = make_station()
    station.loop.step()
    clock = station.loop.clock
    process.last_look = clock.now()

    clock.advance(0.9)
    watchdog.look(station)
    assert station.watchdog_failure is None
    clock.advance(0.2)
    watchdog.look(station)
    assert "suspended or hangs" in station.watchdog_failure
    assert process.kills == 0
    clock.advance(2.0)
    watchdog.look(station)
    watchdog.look(station)
    assert process.kills == 1
    assert station.watchdog_failure == "The watchdog ended (exit code -9)."
    process.last_look = clock.now() + 5.0  # it starts
    clock.advance(1.1)
    watchdog.look(station)

    assert station.watchdog_failure is None
    assert len(warnings) == 2


def test_a_watchdog_that_looks_again_is_left_alone(watchdog, process):
    station = make_station()
    station.loop.step()
    clock = station.loop.clock
    process.last_look = clock.now()
    clock.advance(2.0)
    watchdog.look(station)
    process.last_look = clock.now()
    watchdog.look(station)

    assert station.watchdog_failure is None
    assert process.kills == 0


def test_a_station_that_the_watchdog_ended_says_so(watchdog):
    watchdog.check_end()
    watchdog.heartbeat.note_end_by_watchdog()

    with pytest.raises(EndedByWatchdogError, match="more than 10 s") as caught:
        watchdog.check_end(LoopError("hangs"))

    assert isinstance(caught.value.__cause__, LoopError)


def test_a_station_can_run_without_a_watchdog(warnings):
    watchdog = StationWatchdog(
        load_config(flags={"watchdog.enabled": False}), warnings.append
    )
    station = make_station()

    watchdog.start(Authenticator(None))
    watchdog.announce("x")
    watchdog.guard(station)
    watchdog.look(station)
    watchdog.expect_end()
    watchdog.finish()

    assert (watchdog.url, warnings) == ("", [])


def test_named_tokens_are_told_when_they_begin_and_end_and_after_a_restart(
    watchdog, process
):
    station = make_station()
    authenticator = Authenticator("operator-token")
    watchdog.start(authenticator)
    authenticator.named = NamedTokens()  # those of the disk are read later
    asyncio.run(authenticator.named.create("ada", "viewer", None))
    told = process.tokens

    watchdog.look(station)
    watchdog.look(station)
    assert told == [("viewer", None)]
    process.codes = [1]
    watchdog.look(station)
    watchdog.look(station)
    assert told == [("viewer", None)] * 2
    asyncio.run(authenticator.named.revoke("ada"))
    watchdog.look(station)
    assert told[2:] == [("", None)]
