"""The things around a simulated robot over HTTP."""

import httpx
import numpy as np
import pytest

from station.api.app import Kept, create_app
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


def test_an_object_is_put_with_the_quaternion_that_another_one_has():
    app = create_app(make_franka_station(), Authenticator(OPERATOR, VIEWER))
    box = {"type": "box", "size": [0.1, 0.2, 0.3], "role": "keep_out"}
    with StationClient(URL, OPERATOR, transport=AppTransport(app)) as client:
        place = [0.9, 0.0, 0.4]
        first = client.put_object("wall", **box, position=place, rpy=[0.4, 1.5, -2.0])
        turn = first.orientation
        second = client.put_object("wall-2", **box, position=place, orientation=turn)
    assert second.orientation == pytest.approx(first.orientation, abs=1e-9)


@pytest.mark.parametrize("turn", [[0.0] * 4, [9.0, 0.0, 0.0, 9.0]])
def test_what_is_no_rotation_is_refused_and_adds_nothing(turn):
    app = create_app(make_franka_station(), Authenticator(OPERATOR, VIEWER))
    box = {"type": "box", "size": [0.1] * 3, "position": [0.9, 0.0, 0.4]}
    headers = {"Authorization": f"Bearer {OPERATOR}"}
    with httpx.Client(transport=AppTransport(app), headers=headers) as client:
        answer = client.put(
            f"{URL}/api/v1/scene/wall",
            json={**box, "role": "keep_out", "orientation": turn},
        )
        assert answer.status_code == 422
        assert "must have length 1" in answer.text
        assert "wall" not in client.get(f"{URL}/api/v1/scene").text


def test_an_arm_carries_a_cube_and_leaves_it_elsewhere(tmp_path):
    station = make_franka_station(objects=[{**CUBE, "position": [0.31, 0.0, 0.45]}])
    app = create_app(
        station, Authenticator(OPERATOR, VIEWER), kept=Kept(scenes=tmp_path)
    )
    with StationClient(URL, OPERATOR, transport=AppTransport(app)) as client:
        box = {"type": "box", "size": [0.1, 0.1, 0.1], "position": [0.31, 0.0, 0.4]}
        client.put_object("parcel", role="keep_out", **box)
        client.put_object("wall", **{**box, "position": [0.9, 0, 0.4]}, role="keep_out")
        held = client.attach_object("cube")
        parcel = client.attach_object("parcel", "panda")
        state = client.robot("panda").state()
        assert (held.carried_by, parcel.carried_by) == ("panda", "panda")
        assert state.m_load == pytest.approx(0.1)
        # The hand points down: the cube is as far below the flange as above the floor.
        flange = state.O_T_EE[14] + 0.1034
        assert state.F_x_Cload[2] == pytest.approx(flange - 0.45, abs=2e-3)
        station.loop.step()
        (pair,) = client.clearances()
        assert (pair.link, pair.object) == ("parcel", "wall")

        station.simulation.reset({"panda_joint1": 0.5}, None)
        station.loop.step()
        turned = {one.name: one for one in client.scene()}["parcel"]
        far = np.hypot(*parcel.position[:2])
        assert turned.position[:2] == pytest.approx(
            [far * np.cos(0.5), far * np.sin(0.5)], abs=2e-3
        )
        with pytest.raises(ApiError, match="carried by 'panda'"):
            client.put_object("parcel", position=[0, 0, 0])
        left = client.detach_object("parcel")
        assert left.carried_by == ""
        assert left.position == pytest.approx(turned.position)
        client.detach_object("cube")
        assert client.robot("panda").state().m_load == 0.0
        for name, refusal in (("cub", "no object 'cub'"), ("cube", "No arm carries")):
            with pytest.raises(ApiError, match=refusal):
                client.detach_object(name)
        with pytest.raises(ApiError, match="no arm 'left'"):
            client.attach_object("cube", "left")


def test_a_scene_is_saved_loaded_and_deleted(tmp_path):
    station = make_franka_station(objects=[TABLE])
    app = create_app(
        station, Authenticator(OPERATOR, VIEWER), kept=Kept(scenes=tmp_path)
    )
    with StationClient(URL, OPERATOR, transport=AppTransport(app)) as client:
        client.put_object("ball", type="sphere", size=[0.1], role="keep_out")
        saved = client.scenes.save("cell")
        assert [one["name"] for one in saved.objects] == ["ball"]
        client.remove_object("ball")
        client.put_object("other", type="sphere", size=[0.2], role="keep_out")
        assert {one.name for one in client.scenes.load("cell")} == {"table", "ball"}
        assert client.scenes.names() == ["cell"]
        assert client.scenes.get("cell").objects == saved.objects
        client.scenes.delete("cell")
        with pytest.raises(ApiError, match="no scene 'cell'"):
            client.scenes.load("cell")
        (tmp_path / "bad.yaml").write_text("objects: [{name: x, type: cone}]")
        with pytest.raises(ApiError, match=r"cannot be used: .*cone"):
            client.scenes.load("bad")


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
            ("wall", {"links": ["link9"]}, "no arm has"),
            ("wall", {"margin": -0.1}, "0 to 1000 m"),
        ):
            with pytest.raises(ApiError, match=refusal):
                client.put_object(name, **values)
        with pytest.raises(ApiError, match="no object 'wal'"):
            client.remove_object("wal")
        assert [one.name for one in client.remove_object("wall")] == ["table"]
