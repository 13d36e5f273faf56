"""A request with a key is carried out once, however often it is sent."""

import asyncio

import pytest
from starlette.requests import Request
from starlette.responses import Response

from station.api.idempotency import KEY_HEADER, LIFETIME, MOST_KEYS, IdempotentAnswers
from station.core.clock import ManualClock
from station.core.errors import StoppedError
from station.wire.protocol import REPLAYED_HEADER
from tests.api.conftest import VIEWER

LOAD = "/api/v1/controllers"
SWITCH = "/api/v1/controllers/switch"
SPRING = {"name": "spring", "type": "test/Spring", "params": {"joint": "j"}}


def keyed(key="one"):
    return {KEY_HEADER: key}


def request(body=b"{}", path="/a"):
    async def receive():
        return {"type": "http.request", "body": body, "more_body": False}

    scope = {
        "type": "http",
        "method": "POST",
        "path": path,
        "query_string": b"",
        "headers": [],
        "server": ("station", 80),
    }
    return Request(scope, receive)


class Work:
    """Counts how often it was done; `result` is answered or raised."""

    def __init__(self, result=None):
        self.result = result
        self.done = 0

    async def __call__(self):
        self.done += 1
        await asyncio.sleep(0)
        if isinstance(self.result, Exception):
            raise self.result
        return Response(f"answer {self.done}", 201, {"ETag": "e"})


def ask(answers, work, who="ada", key="one", body=b"{}", path="/a"):
    return asyncio.run(answers.answer(who, key, request(body, path), work))


def test_a_load_that_is_repeated_gets_the_first_answer(operator):
    first = operator.post(LOAD, json=SPRING, headers=keyed())
    again = operator.post(LOAD, json=SPRING, headers=keyed())
    without = operator.post(LOAD, json=SPRING)

    assert (first.status_code, again.status_code, without.status_code) == (
        201,
        201,
        200,
    )
    assert again.content == first.content
    assert again.headers[REPLAYED_HEADER] == "true"
    assert REPLAYED_HEADER not in first.headers
    assert again.headers["content-type"] == first.headers["content-type"]


def test_an_unloading_that_is_repeated_is_no_404(operator):
    operator.post(LOAD, json=SPRING)
    answers = [operator.delete(f"{LOAD}/spring", headers=keyed()) for _ in range(2)]

    assert [answer.status_code for answer in answers] == [200, 200]
    assert operator.delete(f"{LOAD}/spring").status_code == 404


def test_a_switch_is_carried_out_once(operator, client):
    operator.post(LOAD, json=SPRING)
    start, stop = {"start": ["spring"]}, {"stop": ["spring"]}
    operator.post(SWITCH, json=start, headers=keyed())
    operator.post(SWITCH, json=stop)
    again = operator.post(SWITCH, json=start, headers=keyed())

    assert again.json()["started"] == ["spring"]
    assert client.controller("spring").state != "running"
    results = [event.result for event in client.events(kinds=["request"])]
    assert results[-1] == "200 again"
    assert len(client.events(kinds=["switch"])) == 2


def test_a_key_of_another_body_is_refused(operator, client):
    operator.post(LOAD, json=SPRING, headers=keyed())
    other = operator.post(LOAD, json={**SPRING, "name": "b"}, headers=keyed())
    elsewhere = operator.post(SWITCH, json=SPRING, headers=keyed())

    assert other.status_code == elsewhere.status_code == 422
    assert other.json()["code"] == "idempotency_key_reused"
    assert "'one' belongs to another request (POST /api" in other.json()["detail"]
    assert [controller.name for controller in client.controllers()] == ["spring"]


def test_a_request_that_never_began_may_be_corrected_with_its_key(operator):
    bad = operator.post(LOAD, json={"nonsense": 1}, headers=keyed())
    good = operator.post(LOAD, json=SPRING, headers=keyed())

    assert (bad.status_code, good.status_code) == (422, 201)


@pytest.mark.parametrize("key", ["", "a b", "x" * 201, "\x7f"])
def test_malformed_keys_are_refused(operator, key):
    answer = operator.post(LOAD, json=SPRING, headers=keyed(key))

    assert answer.status_code == 422
    assert operator.get(LOAD).json()["controllers"] == []


def test_whoever_may_not_ask_gets_no_kept_answer(operator):
    operator.post(LOAD, json=SPRING, headers=keyed())
    headers = {"Authorization": f"Bearer {VIEWER}", **keyed()}

    assert operator.post(LOAD, json=SPRING, headers=headers).status_code == 403
    headers["Authorization"] = "Bearer wrong"
    assert operator.post(LOAD, json=SPRING, headers=headers).status_code == 401


def test_everybody_has_keys_of_their_own():
    answers, work = IdempotentAnswers(), Work()
    for who in ("ada", "grace", "ada"):
        ask(answers, work, who)

    assert work.done == 2


def test_a_refusal_by_the_station_is_an_answer():
    answers, work = IdempotentAnswers(), Work(StoppedError("It is stopped."))
    first, again = ask(answers, work), ask(answers, work)

    assert work.done == 1
    assert first.status_code == again.status_code == 423
    assert first.body == again.body


def test_a_failure_is_forgotten():
    answers, work = IdempotentAnswers(), Work(RuntimeError("a bug"))
    for _ in range(2):
        with pytest.raises(RuntimeError):
            ask(answers, work)

    assert work.done == 2
    assert len(answers) == 0


def test_a_repetition_waits_for_the_first_request():
    answers, work = IdempotentAnswers(), Work()

    async def both():
        return await asyncio.gather(
            answers.answer("ada", "one", request(), work),
            answers.answer("ada", "one", request(), work),
        )

    first, again = asyncio.run(both())

    assert work.done == 1
    assert first.body == again.body
    assert again.headers[REPLAYED_HEADER] == "true"


def test_answers_are_forgotten_after_their_time_and_when_there_are_too_many():
    clock = ManualClock()
    answers, work = IdempotentAnswers(clock.now), Work()
    ask(answers, work)
    clock.advance(LIFETIME - 1.0)
    ask(answers, work)
    assert work.done == 1
    clock.advance(1.0)
    ask(answers, work)
    assert work.done == 2

    async def fill():
        for number in range(2 * MOST_KEYS):
            await answers.answer("ada", f"k{number}", request(), work)

    asyncio.run(fill())
    assert len(answers) <= MOST_KEYS
