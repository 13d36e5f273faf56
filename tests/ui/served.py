"""Serve an ASGI application on a free port for the length of a test."""

import threading

import uvicorn

from tests.waiting import PATIENCE, wait_until


class Served:
    """A context in which `app` answers at `url`, on a thread of its own."""

    def __init__(self, app):
        config = uvicorn.Config(
            app, port=0, log_level="error", ws="websockets-sansio", lifespan="off"
        )
        self._server = uvicorn.Server(config)
        self._thread = threading.Thread(target=self._server.run)
        self.url = ""

    def __enter__(self):
        self._thread.start()
        assert wait_until(lambda: self._server.started, pause=0.002)
        port = self._server.servers[0].sockets[0].getsockname()[1]
        self.url = f"http://127.0.0.1:{port}"
        return self

    def __exit__(self, *_):
        self._server.should_exit = self._server.force_exit = True
        self._thread.join(PATIENCE)
