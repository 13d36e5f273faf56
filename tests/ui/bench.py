"""A dashboard on a bench: a fake station behind it, a scripted browser before it."""

import asyncio
import threading

import msgspec
import viser
from websockets.sync.client import connect

from station.client import AsyncStationClient
from station.ui.dashboard import Dashboard
from station.ui.gateway.viser_relay import SECRET_HEADER, open_viser
from station.ui.scene.robot_model import load_robot
from tests.ui.fake_station import OPERATOR, FakeStation
from tests.waiting import PATIENCE, wait_until

CAMERA = {
    "type": "ViewerCameraMessage",
    "wxyz": [1.0, 0.0, 0.0, 0.0],
    "position": [1.0, 0.0, 1.0],
    "fov": 0.8,
    "near": 0.01,
    "far": 100.0,
    "image_height": 100,
    "image_width": 100,
    "look_at": [0.0, 0.0, 0.0],
    "up_direction": [0.0, 0.0, 1.0],
}


class Bench:
    """The parts, and what a person would do with them."""

    def __enter__(self):
        self.station = FakeStation().__enter__()
        self.guarded = open_viser("Bench")
        client = AsyncStationClient(self.station.url, OPERATOR, timeout=PATIENCE)
        self.dashboard = Dashboard(
            self.guarded.server, client, load_robot("example-robot-data:panda")
        )
        self.dashboard.start()
        self._socket = connect(
            f"ws://127.0.0.1:{self.guarded.port}/",
            subprotocols=[f"viser-v{viser.__version__}"],
            additional_headers={SECRET_HEADER: self.guarded.secret},
            max_size=None,
            proxy=None,
        )
        self.seen = []
        self._reader = threading.Thread(target=self._read)
        self._reader.start()
        self.send(CAMERA)
        assert self.wait(lambda: self.guarded.server.get_clients())
        return self

    def __exit__(self, *exc):
        self._socket.close()
        self._reader.join(PATIENCE)
        asyncio.run(self.dashboard.stop())
        self.guarded.stop()
        self.station.__exit__(*exc)

    @property
    def link(self):
        """The dashboard's link to the station."""
        return self.dashboard.link

    def enter(self, widget, value):
        """Set a widget as a person in a browser does."""
        self.send({
            "type": "GuiUpdateMessage",
            "uuid": widget._impl.uuid,
            "updates": {"value": value},
        })

    def wait(self, holds, seconds=PATIENCE):
        """Poll until `holds` is true; return its last answer."""
        return wait_until(holds, seconds)

    def send(self, message):
        self._socket.send(msgspec.msgpack.encode(message))

    def _read(self):
        for _frame in self._socket:
            self.seen.append(len(_frame))
