"""Wire models of the bench: one joint is excited, and its response measured."""

from typing import Annotated

from pydantic import Field

from station.wire.base import Items, Measurements, RequestModel, ResponseModel
from station.wire.excitations import Chirp, Multisine, Relay, Sine, Step

LONGEST = 10.0
"""Longest measurement [s]."""
Excitation = Annotated[
    Step | Sine | Chirp | Multisine | Relay, Field(discriminator="kind")
]


class BenchRequest(RequestModel):
    """An excitation of one joint through the set-points of a running controller.

    Attributes:
        excitation: What the joint is asked to do, from where it is.
        duration: How long the response is measured [s], above 0, at most 10.
        settling_band: Half-width of the band of the settling time, as a share of the
            step, above 0 and below 1.

    Example:
        {"excitation": {"kind": "step", "joint": "panda_joint7", "amplitude": 0.1},
         "duration": 1.5}
    """

    excitation: Excitation
    duration: Annotated[float, Field(gt=0.0, le=LONGEST)] = 2.0
    settling_band: Annotated[float, Field(gt=0.0, lt=1.0)] = 0.02


class BenchResponse(ResponseModel):
    """Response of a joint to an excitation.

    Attributes:
        controller: Name of the controller.
        joint: Name of the joint.
        kind: Which excitation it was.
        gains: Gains of the controller during the measurement, by name.
        time: Station time since the beginning [s], shape (k,).
        desired: Set-point in each [rad or m], shape (k,); null before the first one.
        position: Measured position [rad or m], shape (k,).
        velocity: Measured velocity [rad/s or m/s], shape (k,).
        effort: Measured effort [Nm or N], shape (k,).
        output: What the controller commanded [unit of its interface], shape (k,).
        metrics: Metrics of this joint over all cycles, by name; one that does not
            apply is left out.
        units: The unit of each metric, by its name.
        cycles: How many cycles were measured, 1 or more; the arrays have at most some
            hundred of them.
        lost: Cycles that were overwritten before they could be read, 0 or more.
    """

    controller: str
    joint: str
    kind: str
    gains: dict[str, float]
    time: Items[float]
    desired: Measurements
    position: Measurements
    velocity: Measurements
    effort: Measurements
    output: Measurements
    metrics: dict[str, float]
    units: dict[str, str]
    cycles: int
    lost: int
