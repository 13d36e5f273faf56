"""Cameras see what is in front of them, where a pinhole would."""

import json
import math
import os
import subprocess
import sys

import numpy as np
import pytest

# A robot with one link that carries a camera, and a red cube beside it. Prints the
# middle of what is red in each picture [px].
SCRIPT = """
import json, sys
import numpy as np
from station.config.models import CameraSection
from station.app.camera_renderer import DrawnRobot, Stage, looking
from station.wire import JointStates, Scene, SceneObject

asked = json.loads(sys.stdin.read())
cameras = {name: CameraSection(**one) for name, one in asked["cameras"].items()}
robot = DrawnRobot(asked["urdf"], "panda", [0.0, 0.0, 0.0, 0.0, 0.0, 1.5707963])
stage = Stage([robot], cameras)
states = JointStates(
    stamp=0.0, name=["lift"], position=[0.25], velocity=[0.0], effort=[0.0]
)
for place in asked["places"]:
    thing = {"type": "box", "orientation": [0, 0, 0, 1], "mass": 0.1}
    cube = SceneObject(
        name="cube", position=place, size=[0.04] * 3, colour=[255, 0, 0], **thing
    )
    zone = SceneObject(
        name="zone", position=[0, 0, 0], size=[9.0] * 3, solid=False, **thing
    )
    scene = Scene(objects=[cube, zone])
    for name in cameras:
        picture = stage.draw(name, states, scene).astype(float)
        y, x = np.nonzero((picture[..., 0] > 90) & (picture[..., 1] < 40))
        print(json.dumps([name, picture.shape, x.mean(), y.mean()]))
"""
URDF = """<robot name="r"><link name="base"/><link name="head"/>
<joint name="lift" type="prismatic"><parent link="base"/><child link="head"/>
<axis xyz="0 0 1"/><limit lower="0" upper="1" effort="1" velocity="1"/>
</joint></robot>"""


def pinhole(place, position, target, up, fov, size):
    """Return the pixel at which a camera sees a point; x to the right, y down."""
    forward = np.subtract(target, position) / np.linalg.norm(
        np.subtract(target, position)
    )
    right = np.cross(forward, up) / np.linalg.norm(np.cross(forward, up))
    down = np.cross(forward, right)
    way = np.subtract(place, position)
    focal = size[1] / 2.0 / math.tan(fov / 2.0)
    ahead = way @ forward
    return (
        size[0] / 2.0 + focal * (way @ right) / ahead,
        size[1] / 2.0 + focal * (way @ down) / ahead,
    )


@pytest.mark.slow
def test_cameras_see_as_a_pinhole_does(tmp_path):
    urdf = tmp_path / "robot.urdf"
    urdf.write_text(URDF)
    room = {"position": [1.5, -1.0, 1.0], "target": [0.2, 0.1, 0.3], "fov": 0.7}
    hung = {
        "frame": "head",
        "position": [0.3, -0.1, 0.8],
        "target": [0.3, -0.05, 0.0],
        "up": [0.0, 1.0, 0.0],
        "fov": 1.1,
        "width": 200,
        "height": 160,
    }
    places = [[0.2, 0.1, 0.3], [0.0, 0.5, 0.2], [-0.1, 0.45, 0.3]]
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT],
        input=json.dumps({
            "urdf": str(urdf),
            "cameras": {"room": room, "hung": hung},
            "places": places,
        }),
        env={"MUJOCO_GL": "egl", "LP_NUM_THREADS": "1", **os.environ},
        capture_output=True,
        text=True,
    )
    if "GL" in done.stderr:
        pytest.skip("nothing here draws without a screen")
    assert done.returncode == 0, done.stderr
    seen = [json.loads(line) for line in done.stdout.splitlines()]

    assert len(seen) == 6
    for (name, shape, x, y), place in zip(
        seen, np.repeat(places, 2, axis=0), strict=True
    ):
        if name == "room":
            assert shape == [240, 320, 3]
            view = room["position"], room["target"], [0.0, 0.0, 1.0]
            wanted = pinhole(place, *view, room["fov"], (320, 240))
        else:
            assert shape == [160, 200, 3]
            # The base is turned by a quarter about z, and the joint is at 0.25 m.
            own = [place[1], -place[0], place[2] - 0.25]
            view = hung["position"], hung["target"], hung["up"]
            wanted = pinhole(own, *view, hung["fov"], (200, 160))
        # The middle of what is seen of the cube is not quite its own.
        assert (x, y) == pytest.approx(wanted, abs=4.0)
