"""The bench for one joint: its envelope, and a measurement at a fake station."""

import asyncio

import numpy as np
import pytest

from station.ui.response_bench import BenchRefusedError, BenchRequest, measure
from tests.ui.views import controller, element, sample, view

NAMES = ("joint1", "joint2")


def _view(unit="rad", **changes):
    parts = {
        "elements": {"arm": tuple(element(name, unit) for name in NAMES)},
        "samples": {"arm": sample(1.0, desired=0.2, names=NAMES)},
        **changes,
    }
    return view(controller("arm", "running", NAMES), **parts)


class _Samples(dict):
    stamp = np.linspace(5.0, 6.0, 201)


class _Client:
    """A joint that follows its set-points at once, from the sample 40 on."""

    def __init__(self):
        self.sent = []

    async def command(self, name, values, *, epoch):
        self.sent.append((name, list(values), epoch))

    async def collect(self, seconds, topic, *, rate):
        await asyncio.sleep(0.25)
        end = self.sent[0][1][0]
        column = np.where(np.arange(201) < 40, 0.2, end)
        both = np.stack([column, np.full(201, 0.2)], axis=1)
        return _Samples(desired=both, actual=both, output=np.ones((201, 2)))


def test_a_step_is_sent_once_and_measured():
    client = _Client()
    told = asyncio.run(measure(client, _view(), BenchRequest(joint="joint1")))
    assert client.sent == [("arm", [pytest.approx(0.3), 0.2], 1)]
    assert told["metrics"]["overshoot"] == pytest.approx(0.0, abs=1e-9)
    assert told["metrics"]["rise"] == 0.0
    assert told["time"][0] < 0.0 < told["time"][-1]


def test_a_sine_comes_back_to_where_it_began():
    client = _Client()
    request = BenchRequest(
        joint="joint1", kind="sine", seconds=0.2, frequency=5.0, size=0.02
    )
    asyncio.run(measure(client, _view(), request))
    assert client.sent[-1][1] == [0.2, 0.2]
    assert max(abs(values[0] - 0.2) for _, values, _ in client.sent) <= 0.02


@pytest.mark.parametrize(
    ("changes", "request_of", "words"),
    [
        ({"elements": {}}, {}, "takes set-points"),
        ({}, {"joint": "elbow"}, "does not command elbow"),
        ({"unit": "rad/s"}, {}, "takes rad/s"),
        ({"samples": {}}, {}, "not known yet"),
        ({"samples": {"arm": sample(1.0, desired=0.95, names=NAMES)}}, {}, "leave its"),
        ({}, {"kind": "sine", "size": 0.3, "frequency": 2.0}, "3.77 rad/s"),
    ],
)
def test_nothing_moves_outside_the_envelope(changes, request_of, words):
    client = _Client()
    request = BenchRequest(**{"joint": "joint1", **request_of})
    with pytest.raises(BenchRefusedError, match=words):
        asyncio.run(measure(client, _view(**changes), request))
    assert client.sent == []
