"""Parameters become an arm in the world."""

from station.core.parameters import Parameters
from station.hw.franka.franka_parameters import read_parameters
from station.hw.franka.simulated.franka_world import placement_of, simulate_one


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


def test_world_has_the_arm_with_its_thresholds_and_the_things_around_it():
    tree = Parameters()
    tree.set(
        "robot",
        {
            "arm_id": "left",
            "robot_description": "example-robot-data:panda",
            "collision_config": {"upper_force_thresholds_nominal": [33.0] * 6},
        },
    )
    ball = {"name": "ball", "type": "sphere", "size": [0.1], "position": [2, 0, 1]}
    tree.set("scene", {"objects": [ball]})

    world = simulate_one(read_parameters(tree.namespace("robot")), tree)

    assert [thing.name for thing in world.scene()] == ["ball"]
    behavior = world.arms["left"].contact.behavior
    assert list(behavior.upper_force_thresholds_nominal) == [33.0] * 6
