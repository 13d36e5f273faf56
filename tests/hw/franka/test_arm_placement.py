"""Parameters become an arm in the world."""

from station.core.parameters import Parameters
from station.hw.franka.arm_placement import placement_of
from station.hw.franka.franka_parameters import read_parameters


def test_arm_stands_where_the_parameters_say():
    tree = Parameters()
    tree.set(
        "robot",
        {
            "arm_id": "left",
            "robot_description": "example-robot-data:panda",
            "base_xyz": [0.0, 0.5, 0.0],
            "supervisor": {"debounce": 5},
        },
    )
    placement = placement_of(read_parameters(tree.namespace("robot")))
    assert placement.arm_id == "left"
    assert placement.base.xyz == (0.0, 0.5, 0.0)
    assert placement.thresholds.debounce == 5
    assert placement.description.reference == "example-robot-data:panda"
