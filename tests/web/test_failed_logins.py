"""Wrong tokens are slowed and logged; right ones are not."""

import asyncio
import logging

import pytest
from starlette.requests import HTTPConnection

from station.web.failed_logins import MOST_HELD, MOST_SOURCES, FailedLogins
from tests.waiting import PATIENCE


class Time:
    """A clock that the test sets."""

    now = 0.0

    def __call__(self):
        return self.now


@pytest.fixture
def time():
    return Time()


def connection(host):
    return HTTPConnection({"type": "http", "client": (host, 1), "headers": []})


def test_answers_are_held_back_longer_and_longer_up_to_a_second(time):
    failed = FailedLogins(time)

    delays = [failed.note("10.0.0.1") for _ in range(10)]

    assert delays == [0.0, 0.0, 0.0, 0.1, 0.2, 0.4, 0.8, 1.0, 1.0, 1.0]


def test_another_source_is_not_held_back(time):
    failed = FailedLogins(time)
    for _ in range(10):
        failed.note("10.0.0.1")

    assert failed.note("10.0.0.2") == 0.0


def test_after_a_quiet_minute_the_record_is_clean(time):
    failed = FailedLogins(time)
    for _ in range(10):
        failed.note("10.0.0.1")
    time.now += 61.0

    assert failed.note("10.0.0.1") == 0.0


def test_sources_do_not_pile_up(time):
    failed = FailedLogins(time)
    for _ in range(10):
        failed.note("first")
    for number in range(MOST_SOURCES):
        failed.note(str(number))

    assert failed.note("first") == 0.0


def test_failures_are_logged_at_powers_of_two(time, caplog):
    failed = FailedLogins(time)
    with caplog.at_level(logging.WARNING):
        for _ in range(9):
            failed.note("10.0.0.1")

    counts = [record.args[1] for record in caplog.records]
    assert counts == [1, 2, 4, 8]
    assert "10.0.0.1 has sent 8 wrong token(s)" in caplog.text


@pytest.mark.parametrize(
    ("first", "second", "is_same"),
    [
        ("2001:db8::1", "2001:db8::2", True),
        ("2001:db8::1", "2001:db8:0:1::1", False),
        ("::ffff:10.0.0.1", "10.0.0.1", True),
        ("10.0.0.1", "10.0.0.2", False),
    ],
)
def test_a_source_is_an_address_or_a_network(time, first, second, is_same):
    slept = []

    async def sleep(delay):
        slept.append(delay)

    async def fail():
        failed = FailedLogins(time, sleep)
        for _ in range(3):
            await failed.slow_down(connection(first))
        await failed.slow_down(connection(second))

    asyncio.run(fail())

    assert slept == ([0.1] if is_same else [])


def test_only_so_many_answers_are_held_back_at_a_time(time):
    async def fail():
        gate = asyncio.Event()

        async def sleep(_):
            await gate.wait()

        failed = FailedLogins(time, sleep)
        held = [
            asyncio.create_task(failed.slow_down(connection("10.0.0.1")))
            for _ in range(3 + MOST_HELD)
        ]
        await asyncio.sleep(0)
        await asyncio.wait_for(failed.slow_down(connection("10.0.0.1")), PATIENCE)
        gate.set()
        await asyncio.gather(*held)

    asyncio.run(fail())
