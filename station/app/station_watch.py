"""The dashboard's eye on its station: ends with it, or waits for the next one.

It runs in a thread of the dashboard's process and is started before anything heavy is
imported, so that a station killed in these seconds leaves nobody behind.
"""

import os
import threading
import time

from station.app.dashboard_file import dashboard_path, read_dashboard
from station.local.private_files import is_alive, process_start
from station.ui.link.station_access import StationAccess

LOOK_PERIOD = 0.1
"""How often the thread looks [s]."""
ENDING_TIME = 3.0
"""Longest orderly end of the dashboard once nobody adopts it [s]."""


class StationWatch:
    """Follows the station that started this process, and its successors.

    A dashboard that still starts ends at once when its station ends: nobody has logged
    in. A dashboard that serves waits for `window` seconds for a station that adopts it,
    so that a crash does not log everybody out; then it ends, since it has a token.

    Args:
        parent: The process of the station.
        access: How to reach it.
        window: How long to wait for another station [s], >= 0.
    """

    def __init__(self, parent: int, access: StationAccess, window: float) -> None:
        self._station = (parent, process_start(parent))
        self._window = window
        self.access: StationAccess | None = access
        self.is_serving = False
        self.is_over = False

    def start(self) -> bool:
        """Begin to look; return False when the station has ended already."""
        if os.getppid() != self._station[0]:
            return False
        threading.Thread(target=self._run, name="station-watch", daemon=True).start()
        return True

    def _run(self) -> None:
        lost_since: float | None = None
        while True:
            now = time.monotonic()
            if is_alive(*self._station) or self._is_adopted():
                lost_since = None
            # Nothing is shown yet, so nothing is lost.
            elif not self.is_serving:
                os._exit(0)
            elif lost_since is None:
                lost_since = now
                self.access = None
            elif now - lost_since > self._window:
                break
            time.sleep(LOOK_PERIOD)
        self.is_over = True
        dashboard_path(os.getpid()).unlink(missing_ok=True)
        # A dashboard that hangs must not keep the token either.
        time.sleep(ENDING_TIME)
        # Not `sys.exit`: this thread cannot end the others.
        os._exit(1)

    def _is_adopted(self) -> bool:
        record = read_dashboard(os.getpid())
        if record is None:
            return False
        station = (record.station_pid, record.station_started)
        # The record may be that of the station that has just ended.
        if station == self._station or not is_alive(*station):
            return False
        self._station = station
        self.access = StationAccess(
            record.api_url, record.token, record.watchdog_url, record.viewer_token
        )
        return True
