"""How much a request may send."""

import asyncio

import pytest

from station.web.limited_server import announces_more_than, limited


def scope(*lengths):
    headers = [(b"content-length", length.encode()) for length in lengths]
    return {"type": "http", "headers": headers}


@pytest.mark.parametrize(
    ("lengths", "is_too_much"),
    [
        ((), False),
        (("0",), False),
        (("10",), False),
        (("11",), True),
        (("398458880",), True),
        (("9" * 5000,), True),
        (("-1",), True),
        (("+5",), True),
        (("ten",), True),
        (("5", "11"), True),
    ],
)
def test_the_announced_length_is_judged_before_the_body(lengths, is_too_much):
    assert announces_more_than(scope(*lengths), 10) is is_too_much


def test_a_body_without_a_length_is_read_up_to_the_limit():
    parts = [{"type": "http.request", "body": b"12345"} for _ in range(3)]

    async def receive():
        return parts.pop(0)

    async def read():
        limit = limited(receive, 10, ValueError("too large"))
        await limit()
        await limit()
        with pytest.raises(ValueError, match="too large"):
            await limit()

    asyncio.run(read())
