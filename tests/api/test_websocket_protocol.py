"""Getting rid of a client over uvicorn's protocol."""

from queue import SimpleQueue

import pytest
from websockets.exceptions import ConnectionClosed

from station.api.server import StreamProtocol
from tests.api.test_server import deaf_client, open_stream
from tests.waiting import PATIENCE


@pytest.fixture
def protocols(monkeypatch):
    """Return the list of all protocols that are made."""
    made = []
    original = StreamProtocol.connection_made

    def noting(self, transport):
        made.append(self)
        original(self, transport)

    monkeypatch.setattr(StreamProtocol, "connection_made", noting)
    return made


def test_a_client_that_reads_learns_the_code(server, protocols):
    with open_stream(server) as stream:
        stream.recv()
        (protocol,) = protocols
        protocol.loop.call_soon_threadsafe(protocol.abort, 4408, "why")
        protocol.loop.call_soon_threadsafe(protocol.abort, 4409, "again")
        with pytest.raises(ConnectionClosed) as caught:
            while_open(stream)

    assert (caught.value.rcvd.code, caught.value.rcvd.reason) == (4408, "why")


def while_open(stream):
    while True:
        stream.recv(timeout=PATIENCE)


def test_a_client_that_does_not_is_cut_off(server, protocols, monkeypatch):
    monkeypatch.setattr("station.api.server.GRACE", 0.01)
    raw = deaf_client(server)
    (protocol,) = protocols
    protocol.loop.call_soon_threadsafe(protocol.abort, 4408, "why")

    raw.settimeout(20.0)  # a ping without an answer ends the connection after 25 s
    with pytest.raises((ConnectionResetError, EOFError)):
        read_all(raw)
    raw.close()


def read_all(raw):
    while raw.recv(65536):
        pass
    raise EOFError


def test_a_client_that_has_just_closed_does_not_disturb_the_end_of_the_server(
    server, monkeypatch
):
    outcomes = SimpleQueue()
    original = StreamProtocol.handle_close

    def end_at_once(self, event):
        original(self, event)
        try:
            outcomes.put(self.shutdown())
        except Exception as error:
            outcomes.put(error)
            raise

    monkeypatch.setattr(StreamProtocol, "handle_close", end_at_once)
    with open_stream(server) as stream:
        stream.recv()

    assert outcomes.get(timeout=PATIENCE) is None
