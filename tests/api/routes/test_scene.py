"""The things around a simulated robot over HTTP."""

import httpx
import pytest

from station.api.app import create_app
from station.api.auth import Authenticator
from station.client import StationClient
from tests.api.conftest import OPERATOR, URL, VIEWER, AppTransport
from tests.franka_station import make_franka_station

CUBE = {
    "name": "cube",
    "type": "box",
    "size": [0.05, 0.05, 0.05],
    "position": [0.5, 0.4, 0.2],
    "mass": 0.1,
}
TABLE = {"name": "table", "type": "table", "size": [1, 1, 0.1], "position": [2, 0, 0.1]}


def test_things_are_where_the_simulation_has_them():
    station = make_franka_station(objects=[CUBE, TABLE])
    app = create_app(station, Authenticator(OPERATOR, VIEWER))
    with StationClient(URL, VIEWER, transport=AppTransport(app)) as client:
        cube, table = client.scene()
        station.loop.step(1000)
        fallen = client.scene()[0]
        contacts = client.simulation.contacts()

    assert (cube.type, cube.size, cube.mass) == ("box", [0.05] * 3, 0.1)
    assert cube.position == pytest.approx([0.5, 0.4, 0.2], abs=1e-4)
    assert cube.orientation == pytest.approx([0.0, 0.0, 0.0, 1.0])
    assert fallen.position == pytest.approx([0.5, 0.4, 0.025], abs=1e-3)
    assert table.position == pytest.approx([2.0, 0.0, 0.05])
    assert table.mass == 0.0
    # The cube lies on the floor with its weight, 0.1 kg x 9.81 m/s^2.
    assert {tuple(contact.bodies) for contact in contacts} == {("world", "cube")}
    weight = sum(contact.force[2] for contact in contacts)
    assert weight == pytest.approx(0.981, rel=0.02)
    assert all(abs(contact.position[2]) < 1e-3 for contact in contacts)


def test_a_robot_without_a_scene_has_no_things(operator: httpx.Client):
    assert operator.get("/api/v1/scene").json() == {
        "objects": [],
        "contacts": [],
        "bases": [],
    }
