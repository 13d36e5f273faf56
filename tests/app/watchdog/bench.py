"""A watch over a page of the test, with everything it does kept in lists."""

from station.app.watchdog.watch import Watch, WatchdogSettings
from station.core.loop.heartbeat import Heartbeat, LoopLife, Phase

OPERATOR, VIEWER = "operator-token", "viewer-token"
NOW = 5000.0


class Bench:
    """One watched station: its page, the signals it got, and the lines that were told.

    Args:
        folder: Where incident files go.
        settings: Settings that differ from the usual ones.
    """

    def __init__(self, folder, **settings):
        self.folder = folder
        self.settings = WatchdogSettings(
            pid=4711,
            operator_token=OPERATOR,
            viewer_token=VIEWER,
            incident_directory=str(folder / "incidents"),
            **settings,
        )
        self.heartbeat = Heartbeat()
        self.heartbeat.beats[0] = NOW
        self.heartbeat.life = LoopLife.RUNNING
        self.heartbeat.phase = Phase.RUNNING
        self.told, self.sent = [], []
        self.stacks = ""
        self.watch = Watch(
            self.heartbeat,
            self.settings,
            tell=self.told.append,
            send=self.sent.append,
            read_stacks=lambda: self.stacks,
        )

    def look(self, *times):
        """Look at these times after the last heartbeat [s]."""
        for time in times:
            self.watch.look(NOW + time)
