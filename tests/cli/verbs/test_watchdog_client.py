"""A stop through a watchdog, by a program that may rely on nothing else."""

import threading
from http.server import BaseHTTPRequestHandler, HTTPServer

import pytest

from station.cli.verbs.motion import WatchdogError, stop_through_watchdog
from tests.waiting import PATIENCE


@pytest.fixture
def answering():
    """Return a function that answers the next request with a text and a status."""
    threads = []

    def answer(status, text):
        class Handler(BaseHTTPRequestHandler):
            def do_POST(self):
                self.send_response(status)
                self.end_headers()
                self.wfile.write(text.encode())

            def log_message(self, *_):
                """Keep quiet."""

        server = HTTPServer(("127.0.0.1", 0), Handler)
        thread = threading.Thread(target=server.handle_request)
        thread.start()
        threads.append((thread, server))
        return f"http://127.0.0.1:{server.server_port}"

    yield answer
    for thread, server in threads:
        thread.join(PATIENCE)
        server.server_close()


def test_what_the_watchdog_says_is_handed_on(answering):
    url = answering(200, '{"carried_out": true, "detail": "Done."}')

    stopped = stop_through_watchdog(url, "token", "smoke")

    assert (stopped.carried_out, stopped.detail) == (True, "Done.")


def test_an_answer_that_is_no_watchdogs_is_an_error(answering):
    with pytest.raises(WatchdogError, match="does not answer"):
        stop_through_watchdog(answering(200, "<html>"), "token", "smoke")


def test_a_refusal_is_an_error(answering):
    with pytest.raises(WatchdogError, match="refuses: No"):
        stop_through_watchdog(answering(401, '{"detail": "No."}'), "token", "smoke")
