"""Watch the dashboard's station: end with it, or wait for the next one.

A thread of the dashboard's process watches. It starts before slow imports, so that a
station that is killed in these seconds leaves no dashboard behind.
"""

import os
import threading
import time

from station.app.dashboard_file import dashboard_path, read_dashboard
from station.local.private_files import is_alive, process_start
from station.ui.link.station_access import StationAccess

LOOK_PERIOD = 0.1
"""Time between two looks of the thread [s]."""
ENDING_TIME = 3.0
"""Longest orderly end of a dashboard that no station has adopted [s]."""


class StationWatch:
    """Follows the station that started this process, and its successors.

    A dashboard that is still starting ends at once with its station, because no user
    has logged in. A serving dashboard waits `window` seconds for a station that adopts
    it, so that a crash does not log users out. Then it ends, because it holds a token.

    Args:
        parent: Process number of the station.
        access: Address and tokens of the station.
        window: How long to wait for another station [s], >= 0.
    """

    def __init__(self, parent: int, access: StationAccess, window: float) -> None:
        self._station = (parent, process_start(parent))
        self._window = window
        self.access: StationAccess | None = access
        self.is_serving = False
        self.is_over = False

    def start(self) -> bool:
        """Start the thread; return False if the station has already ended."""
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
            # The dashboard does not serve yet, so no session is lost.
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
        # Even a dashboard that hangs must not keep the token.
        time.sleep(ENDING_TIME)
        # `sys.exit` would end this thread only.
        os._exit(1)

    def _is_adopted(self) -> bool:
        record = read_dashboard(os.getpid())
        if record is None:
            return False
        station = (record.station_pid, record.station_started)
        # The record may still name the station that has just ended.
        if station == self._station or not is_alive(*station):
            return False
        self._station = station
        self.access = StationAccess(
            record.api_url, record.token, record.watchdog_url, record.viewer_token
        )
        return True
