"""The things around a simulated robot over HTTP."""

import httpx
import pytest

from station.api.app import create_app
from station.api.auth import Authenticator
from station.client import ApiError, StationClient
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
        "clearances": [],
    }


def test_places_are_put_moved_and_removed_while_the_station_runs():
    station = make_franka_station(objects=[TABLE])
    app = create_app(station, Authenticator(OPERATOR, VIEWER))
    with StationClient(URL, OPERATOR, transport=AppTransport(app)) as client:
        assert client.clearances() == []
        wall = client.put_object(
            "wall", type="box", size=[0.1, 1, 1], position=[1, 0, 0.5], role="keep_out"
        )
        station.loop.step()
        state, (pair,) = client.robot("panda").state(), client.clearances()
        assert state.least_clearance == pair.distance
        assert state.nearest_pair == [pair.link, "wall"]
        changed = client.put_object("wall", position=[0.9, 0, 0.5], margin=0.1)
        moved = client.put_object("table", position=[1.5, 0, 0.1])

        assert (wall.role, wall.margin, wall.solid) == ("keep_out", 0.02, False)
        assert (changed.size, changed.margin) == ([0.1, 1, 1], 0.1)
        assert moved.position == pytest.approx([1.5, 0.0, 0.05])
        for name, values, refusal in (
            ("cube", {"type": "sphere", "size": [0.1]}, "built once"),
            ("table", {"size": [1, 1, 0.2]}, "built once"),
            ("wall", {"links": ["link9"]}, "does not have"),
            ("wall", {"margin": -0.1}, "0 or more"),
        ):
            with pytest.raises(ApiError, match=refusal):
                client.put_object(name, **values)
        with pytest.raises(ApiError, match="no object 'wal'"):
            client.remove_object("wal")
        assert [one.name for one in client.remove_object("wall")] == ["table"]
