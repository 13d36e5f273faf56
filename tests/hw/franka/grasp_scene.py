"""A station over an arm with a box between its fingers, and what the box feels."""

import mujoco
import numpy as np

from station.core.facade.station import Station
from station.core.franka import GripperState
from station.core.franka.gripper_services import Grippers
from tests.franka_station import make_franka_station

WIDTH = 0.03
"""Of the box, across the fingers [m]."""
BOX = {
    "name": "box",
    "type": "box",
    "size": [0.03, WIDTH, 0.05],
    "position": [0.307, 0.0, 0.487],
    "mass": 0.1,
}
PILLAR = {
    "name": "pillar",
    "type": "box",
    "size": [0.02, 0.02, 0.462],
    "position": [0.307, 0.0, 0.231],
}


def make_grasp_station(**box: object) -> Station:
    """Return a station whose box stands on a pillar between the open fingers."""
    return make_franka_station(objects=[{**BOX, **box}, PILLAR])


def run_until_done(station: Station, most: int = 5_000) -> GripperState:
    """Step until the gripper's command has ended; return the state."""
    for _ in range(most):
        station.loop.step()
        state = Grippers(station.robots).state("panda")
        if state.command is None:
            return state
    raise AssertionError(f"it has not ended after {most} cycles: {state}")


def box_height(station: Station) -> float:
    """Return how high the box is [m]."""
    return station.scene()[0].position[2]


def contact_force(station: Station, finger: str) -> float:
    """Return how hard a finger presses the box, across the fingers [N]."""
    world = station.loop.hw.simulated_world().world
    model, data = world.model, world.data
    pair = {model.body("box").id, model.body(finger).id}
    force, across = np.zeros(6), 0.0
    for index in range(data.ncon):
        contact = data.contact[index]
        bodies = {model.geom_bodyid[contact.geom1], model.geom_bodyid[contact.geom2]}
        if bodies == pair:
            mujoco.mj_contactForce(model, data, index, force)
            across += (contact.frame.reshape(3, 3).T @ force[:3])[1]
    return abs(across)
