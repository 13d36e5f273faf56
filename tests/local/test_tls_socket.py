"""TLS sockets that are read by one thread and written by another."""

import socket
import ssl
import threading

import pytest

from station.local.tls import trust
from station.local.tls_socket import TlsSocket
from tests.certificates import make_certificate

MESSAGES = 500
SIZE = 2000


class Watched:
    """The TLS of a socket; notes whether two threads were inside of it at once."""

    def __init__(self, real):
        self.real = real
        self.met = False
        self._inside = threading.Lock()

    def read(self, *given):
        return self._alone(self.real.read, *given)

    def write(self, *given):
        return self._alone(self.real.write, *given)

    def _alone(self, act, *given):
        if not self._inside.acquire(blocking=False):
            self.met = True
            return act(*given)
        with_nobody_else = self._inside
        try:
            return act(*given)
        finally:
            with_nobody_else.release()


def _echo(connection):
    with connection:
        while data := connection.recv(65536):
            connection.sendall(data)


@pytest.fixture
def echoing(tmp_path):
    """Connect to a server that sends everything back, over TLS."""
    tls = make_certificate(tmp_path)
    ours, theirs = socket.socketpair()
    server = threading.Thread(
        target=lambda: _echo(tls.context().wrap_socket(theirs, server_side=True))
    )
    server.start()
    context = trust("https://127.0.0.1", str(tls.certificate))
    with context.wrap_socket(ours, server_hostname="127.0.0.1") as connection:
        yield connection
        connection.shutdown(socket.SHUT_RDWR)
    server.join()


def test_a_client_gets_such_sockets(echoing):
    assert isinstance(echoing, TlsSocket)
    echoing.sendall(b"hello")
    assert echoing.recv(100) == b"hello"


def test_reading_and_writing_threads_never_meet_inside_of_tls(echoing):
    watched = echoing._sslobj = Watched(echoing._sslobj)
    sent = b"".join(number.to_bytes(SIZE, "big") for number in range(MESSAGES))
    received = bytearray()

    def read():
        while len(received) < len(sent):
            received.extend(echoing.recv(65536))

    reader = threading.Thread(target=read)
    reader.start()
    for start in range(0, len(sent), SIZE):
        echoing.sendall(sent[start : start + SIZE])
    reader.join()
    assert not watched.met
    assert bytes(received) == sent


def test_a_read_ends_after_its_timeout(echoing):
    echoing.settimeout(0.01)
    assert echoing.gettimeout() == 0.01
    with pytest.raises(TimeoutError):
        echoing.recv(1)


def test_a_reading_thread_ends_when_another_one_closes(echoing):
    ended = []
    reader = threading.Thread(target=lambda: ended.append(echoing.recv(1)))
    reader.start()
    echoing.shutdown(socket.SHUT_RDWR)
    reader.join()
    assert ended == [b""]


def test_a_handshake_has_its_time_limit(tmp_path):
    tls = make_certificate(tmp_path)
    ours, theirs = socket.socketpair()
    context = trust("https://127.0.0.1", str(tls.certificate))
    ours.settimeout(0.01)
    with theirs, ours, pytest.raises((TimeoutError, ssl.SSLError)):
        context.wrap_socket(ours, server_hostname="127.0.0.1")
