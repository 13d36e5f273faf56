"""An endpoint in the test's own thread, and the checks against it.

The server makes a cycle whenever the client waits: nothing depends on the wall clock.
"""

import json
import os
from contextlib import nullcontext
from itertools import count
from types import SimpleNamespace

import pytest

from station.hw.franka.fci.driver.network import FciNetwork
from station.hw.franka.fci.server.fci_server import FciServer, FciSettings
from station.testing.fci_conformance import dialog

SUITE = "station.testing.fci_conformance"
# A loopback address of this process alone: libfranka's ports are fixed.
HOST = f"127.16.{os.getpid() // 250 % 250}.{os.getpid() % 250 + 1}"


class PumpedClient(FciNetwork):
    """Sockets of a client whose waiting lets a server run.

    Args:
        server: The server.
        port: Its TCP port.
        late_at: Waits in which 30 cycles pass instead of one.
    """

    def __init__(self, server, port, late_at):
        self.server, self.late_at, self.waits = server, late_at, 0
        super().__init__(HOST, port)

    def pump(self, cycles=1):
        left = iter(range(cycles))
        self.server.run(lambda: next(left, None) is None)

    def wait(self, buffer):
        self.waits += 1
        self.pump(30 if self.waits in self.late_at else 1)
        return super().wait(buffer)

    def receive(self, timeout):
        while not (data := super().receive(0.0)) and timeout > 0.0:
            self.pump()
            timeout -= 0.001
        return data

    def close(self):
        super().close()
        self.pump(2)  # the server notices that the client has gone, and listens


def run_checks(
    arm,
    tmp_path,
    monkeypatch,
    *,
    features,
    arguments=(),
    late_at=(),
):
    """Return the report of the checks against an arm."""
    seconds = count()
    # A clock that is always late: the server polls once, and makes its cycle.
    server = FciServer(
        arm, None, FciSettings(HOST), features, lambda: float(next(seconds))
    )
    now = SimpleNamespace(monotonic=lambda: arm.state.time, sleep=lambda _s: None)
    monkeypatch.setattr(dialog, "time", now)
    monkeypatch.setattr(
        dialog, "open_network", lambda _host, port: PumpedClient(server, port, late_at)
    )
    monkeypatch.setattr(f"{SUITE}.test_reading.open_network", dialog.open_network)
    monkeypatch.setattr(f"{SUITE}.plugin.request_realtime_priority", lambda: "")
    monkeypatch.setattr(f"{SUITE}.plugin.realtime_interpreter", nullcontext)
    monkeypatch.chdir(tmp_path)  # where no conftest.py is
    report = tmp_path / "report.json"
    command = ["-c", os.devnull, "-p", "no:cacheprovider", "-p", f"{SUITE}.plugin"]
    command += ["--pyargs", SUITE, "-q", "--no-header", "--tb=short", "--fci", HOST]
    try:
        code = pytest.main([*command, f"--fci-report={report}", *arguments])
    finally:
        server.close()
    found = json.loads(report.read_text(encoding="utf-8"))
    return code, {one["check"]: one for one in found["checks"]}, found
