"""How deep bodies are in the floor."""

import mujoco
import pytest

from station.hw.mujoco.mujoco_simulation import depth_in_floor

WORLD = """<mujoco><worldbody><geom name="floor" type="plane" size="0 0 1"/>
<body pos="0 0 {height}" euler="{turn} 0 0"><freejoint/>
<geom group="{group}" {shape}/></body></worldbody></mujoco>"""


@pytest.mark.parametrize(
    ("shape", "turn", "reach"),
    [
        ('type="sphere" size="0.1"', 0, 0.1),
        ('type="box" size="0.1 0.1 0.2"', 0, 0.2),
        ('type="box" size="0.1 0.1 0.1"', 45, 0.1 * 2**0.5),
        ('type="cylinder" size="0.1 0.3"', 0, 0.3),
        ('type="cylinder" size="0.1 0.3"', 90, 0.1),
    ],
)
def test_depth_is_that_of_the_lowest_point(shape, turn, reach) -> None:
    xml = WORLD.format(height=0.05, turn=turn, group=3, shape=shape)
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert depth_in_floor(model, data) == pytest.approx(reach - 0.05, abs=1e-6)


@pytest.mark.parametrize(("height", "group"), [(0.5, 3), (0.05, 0)])
def test_robots_above_the_floor_and_objects_do_not_count(height, group) -> None:
    xml = WORLD.format(height=height, turn=0, group=group, shape='size="0.1"')
    model = mujoco.MjModel.from_xml_string(xml)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert depth_in_floor(model, data) == 0.0
