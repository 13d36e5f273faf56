"""Where the bodies of a MuJoCo world touch, and with which force."""

import mujoco
import numpy as np

from station.core.hardware.robot_report import ContactReport

MOST_CONTACTS = 64
"""Contacts reported at most: a pile of objects has hundreds."""


def touching(model: mujoco.MjModel, data: mujoco.MjData) -> list[ContactReport]:
    """Return the contacts of the last step. For the thread that steps the world.

    MuJoCo gives a force in the axes of the contact, whose first axis points from the
    first geometry to the second one (MuJoCo documentation, `mjContact`,
    `mj_contactForce`).

    Args:
        model: The world's model.
        data: The world's data.
    """
    found = []
    wrench = np.zeros(6)
    for i in range(min(data.ncon, MOST_CONTACTS)):
        contact = data.contact[i]
        mujoco.mj_contactForce(model, data, i, wrench)
        axes = contact.frame.reshape(3, 3)  # its rows
        first, second = (_body_of(model, geom) for geom in contact.geom)
        found.append(
            ContactReport(
                (first, second),
                tuple(contact.pos.tolist()),
                tuple((axes.T @ wrench[:3]).tolist()),
            )
        )
    return found


def _body_of(model: mujoco.MjModel, geom: int) -> str:
    name: str = model.body(model.geom_bodyid[geom]).name
    return name
