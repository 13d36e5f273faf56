"""Move one joint by a step or a sine, and measure how it follows.

The set-points go through the running controller like those of a person, inside an
envelope that is small enough for an arm on a table: `LARGEST`, `LONGEST`, `FASTEST`.
"""

import asyncio
import math
from dataclasses import asdict
from typing import Annotated, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from station.client import AsyncStationClient
from station.ui.operate_model import POSITION_UNITS, choose_operated
from station.ui.response_metrics import (
    Array,
    ResponseMetrics,
    step_metrics,
    tracking_metrics,
)
from station.ui.station_view import StationView

LARGEST = 0.3
"""Largest step, or amplitude of a sine [rad]."""
LONGEST = 10.0
"""Longest measurement [s]."""
FASTEST = 1.0
"""Largest speed of a sine, amplitude times angular frequency [rad/s]."""
_LEAD = 0.2
_SINE_PERIOD = 0.02
_MOST_POINTS = 400


class BenchRequest(BaseModel):
    """What to measure.

    Attributes:
        joint: Which joint moves.
        kind: `step` goes there and stays; `sine` swings and comes back.
        size: Step, or amplitude of the sine [rad], within plus and minus `LARGEST`.
        seconds: How long to measure [s].
        frequency: Of the sine [Hz].
    """

    model_config = ConfigDict(extra="forbid", strict=True)

    joint: str = Field(min_length=1, max_length=128)
    kind: Literal["step", "sine"] = "step"
    size: Annotated[float, Field(ge=-LARGEST, le=LARGEST)] = 0.1
    seconds: Annotated[float, Field(gt=0.0, le=LONGEST)] = 2.0
    frequency: Annotated[float, Field(gt=0.0, le=5.0)] = 0.5


class BenchRefusedError(Exception):
    """The measurement would leave the envelope, or nothing takes its set-points."""


async def measure(
    client: AsyncStationClient, view: StationView, request: BenchRequest
) -> dict[str, object]:
    """Move the joint and return what was measured.

    Args:
        client: The station, with the credential of the person.
        view: What is known of the station.
        request: What to measure.

    Returns:
        `time` [s], `desired`, `actual` and `output`, at most some hundred numbers each,
        and `metrics`.

    Raises:
        BenchRefusedError: It would leave the envelope; nothing has moved.
        ApiError: The station refuses, e.g. because it was stopped meanwhile.
    """
    controller, start, index = _prepared(view, request)
    epoch = view.epoch
    topic = f"controller_state/{controller}"
    measuring = asyncio.create_task(
        client.collect(_LEAD + request.seconds, topic, rate=200.0)
    )
    try:
        await asyncio.sleep(_LEAD)
        if request.kind == "step":
            await _send(client, controller, start, index, request.size, epoch)
        else:
            await _swing(client, controller, start, index, request, epoch)
        samples = await measuring
    finally:
        measuring.cancel()
    desired, actual = samples["desired"][:, index], samples["actual"][:, index]
    output = samples["output"][:, index]
    began = _beginning(desired, start[index])
    time = samples.stamp - samples.stamp[began]
    metrics = (
        step_metrics(time, actual, output, start[index], start[index] + request.size)
        if request.kind == "step"
        else tracking_metrics(desired[began:], actual[began:], output[began:])
    )
    return _told(controller, request, time, [desired, actual, output], metrics)


def _prepared(view: StationView, request: BenchRequest) -> tuple[str, list[float], int]:
    """Return the controller, its present set-point and the index of the joint.

    Raises:
        BenchRefusedError: Nothing that runs takes positions of that joint, or the
            motion would leave its range.
    """
    operated = choose_operated(view)
    if operated.reason or not operated.name:
        raise BenchRefusedError(operated.reason or "No controller takes set-points.")
    names = [element.name for element in operated.elements]
    if request.joint not in names:
        raise BenchRefusedError(
            f"{operated.name} does not command {request.joint}; it commands "
            f"{', '.join(names)}."
        )
    index = names.index(request.joint)
    element = operated.elements[index]
    if element.unit not in POSITION_UNITS:
        raise BenchRefusedError(
            f"{operated.name} takes {element.unit}. Start a position controller."
        )
    speed = abs(request.size) * 2.0 * math.pi * request.frequency
    if request.kind == "sine" and speed > FASTEST:
        raise BenchRefusedError(
            f"The sine would reach {speed:.2f} rad/s; allowed are {FASTEST:g} rad/s. "
            "Choose a smaller amplitude or a lower frequency."
        )
    sample = view.samples.get(operated.name)
    start = [] if sample is None else [v for v in sample.desired if v is not None]
    if len(start) != len(names) or request.size == 0.0:
        raise BenchRefusedError("The set-point is not known yet, or the size is 0.")
    both = request.kind == "sine"
    ends = [start[index] + request.size, start[index] - request.size * both]
    low = -math.inf if element.minimum is None else element.minimum
    high = math.inf if element.maximum is None else element.maximum
    if not all(low <= end <= high for end in ends):
        raise BenchRefusedError(
            f"{request.joint} would leave its range of {low:g} to {high:g}. Choose "
            "another size, or move the joint away from its limit."
        )
    return operated.name, start, index


async def _send(
    client: AsyncStationClient,
    controller: str,
    start: list[float],
    index: int,
    offset: float,
    epoch: int | None,
) -> None:
    values = [*start[:index], start[index] + offset, *start[index + 1 :]]
    await client.command(controller, values, epoch=epoch)


async def _swing(
    client: AsyncStationClient,
    controller: str,
    start: list[float],
    index: int,
    request: BenchRequest,
    epoch: int | None,
) -> None:
    """Send a sine of whole periods, which ends where it began."""
    turns = max(1, int(request.seconds * request.frequency))
    loop = asyncio.get_running_loop()
    began = loop.time()
    while (passed := loop.time() - began) < turns / request.frequency:
        angle = 2.0 * math.pi * request.frequency * passed
        offset = request.size * math.sin(angle)
        await _send(client, controller, start, index, offset, epoch)
        await asyncio.sleep(_SINE_PERIOD)
    await _send(client, controller, start, index, 0.0, epoch)


def _beginning(desired: Array, start: float) -> int:
    """Return the index of the first sample that was told to be elsewhere."""
    moved = np.abs(desired - start) > 1e-9
    return int(np.argmax(moved)) if bool(np.any(moved)) else 0


def _told(
    controller: str,
    request: BenchRequest,
    time: Array,
    columns: list[Array],
    metrics: ResponseMetrics,
) -> dict[str, object]:
    every = max(1, math.ceil(time.size / _MOST_POINTS))
    desired, actual, output = (column[::every].tolist() for column in columns)
    return {
        "controller": controller,
        "joint": request.joint,
        "kind": request.kind,
        "size": request.size,
        "time": time[::every].tolist(),
        "desired": desired,
        "actual": actual,
        "output": output,
        "metrics": asdict(metrics),
    }
