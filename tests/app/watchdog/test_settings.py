"""What the station tells its watchdog when it starts it."""

import json

from station.app.watchdog.__main__ import _settings
from station.app.watchdog.settings import LOOK_PERIOD, NOTICE_AFTER, WatchdogSettings


def test_settings_survive_their_way_through_the_pipe():
    settings = WatchdogSettings(
        4711, "operator", "viewer", "/run/incidents", (("hold", "left"), ("hold",))
    )

    assert _settings(json.loads(json.dumps(settings._asdict()))) == settings


def test_a_standstill_is_noticed_within_a_tenth_of_a_second():
    assert NOTICE_AFTER + 2 * LOOK_PERIOD <= 0.1
