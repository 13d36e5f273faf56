"""A user's script, which mypy reads: the types of the client reach whoever calls it."""

from typing import assert_type

import numpy as np
from numpy.typing import NDArray

import station
from station.client import Pose, StationClient
from station.wire import JointStates

with StationClient() as client, client.stream("joint_states") as stream:
    client.move_to(Pose((0.4, 0.0, 0.4)))
    assert_type(stream.receive(1.0).read(JointStates).position, list[float | None])
    assert_type(client.collect(1.0)["position"], NDArray[np.float64])
with station.open("x.yaml") as robot:
    assert_type(robot.positions(), dict[str, float])
client.move_to(3)  # type: ignore[arg-type]
