"""Pictures of cameras, from a process that draws, or cannot."""

import sys

import anyio
import pytest

from station.api.app import create_app
from station.api.cameras import Cameras
from station.config.models import CameraSection

CELL = CameraSection(position=[1.0, 0.0, 1.0], target=[0.0, 0.0, 0.0], rate=30.0)
# Reads an assignment, and answers each name with a picture that says what was asked.
DRAWS = """
import json, sys
told = json.loads(sys.stdin.readline())
for k in range(1000):
    name = sys.stdin.readline().strip()
    if not name:
        break
    content = f"{name} {k} {told['url']} {told['cameras'][name]['fov']}".encode()
    line = {"name": name, "stamp": 0.5 + k, "size": len(content)}
    sys.stdout.buffer.write(json.dumps(line).encode() + b"\\n" + content)
    sys.stdout.buffer.flush()
"""
CANNOT = """
import json
print(json.dumps({"error": "ImportError: no EGL", "size": 0}))
"""


@pytest.fixture
def script():
    """Return the script of the renderer."""
    return DRAWS


@pytest.fixture
def app(station, authenticator, script):
    """Return an app with one camera."""
    command = (sys.executable, "-c", script)
    cameras = Cameras({"cell": CELL}, lambda: {"url": "here"}, command)
    yield create_app(station, authenticator, cameras=cameras)
    cameras.close()


def test_cameras_are_listed_without_drawing(operator):
    assert operator.get("/api/v1/cameras").json() == {
        "cameras": [
            {
                "name": "cell",
                "frame": "",
                "width": 320,
                "height": 240,
                "rate": 30.0,
                "fault": "",
            }
        ]
    }


def test_a_picture_is_a_jpeg_with_its_station_time(operator):
    answer = operator.get("/api/v1/cameras/cell")

    name, number, *told = answer.text.split()
    assert [name, *told] == ["cell", "here", "0.8"]
    assert answer.headers["content-type"] == "image/jpeg"
    assert float(answer.headers["X-Station-Time"]) == float(number) + 0.5


def test_pictures_are_saved_by_the_client(client, tmp_path):
    assert [camera.name for camera in client.cameras.list().cameras] == ["cell"]

    saved = client.cameras.save("cell", tmp_path / "cell.jpg")

    assert saved.read_bytes().startswith(b"cell ")


def test_a_stream_has_each_picture_once(app):
    cameras = app.state.services.cameras

    async def first_two():
        pictures = cameras.pictures("cell")
        return [(await anext(pictures)).stamp for _ in range(2)]

    first, second = anyio.run(first_two)
    assert first < second


def test_an_unknown_camera_is_told_those_there_are(operator):
    answer = operator.get("/api/v1/cameras/door")

    assert answer.status_code == 404
    assert "cell" in answer.json()["remedy"]


@pytest.mark.parametrize(
    ("script", "reason"),
    [(CANNOT, "no EGL"), ("raise SystemExit(3)", "exit code 3")],
)
def test_what_cannot_be_drawn_is_refused_with_the_reason(operator, reason):
    answer = operator.get("/api/v1/cameras/cell")

    assert answer.status_code == 503
    assert reason in answer.json()["detail"]
    assert "EGL" in answer.json()["remedy"]
    assert reason in operator.get("/api/v1/cameras").json()["cameras"][0]["fault"]
