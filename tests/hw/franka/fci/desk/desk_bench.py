"""A Desk with an arm that notes what it was asked for, and clients of its REST."""

from concurrent.futures import Future
from types import SimpleNamespace

import httpx

from station.core.franka import RobotMode
from station.hw.franka.arm.franka_kinematics import IDENTITY
from station.hw.franka.arm.rigid_body import RigidBody
from station.hw.franka.fci.desk.desk_state import Desk

HAND = RigidBody(0.73, (-0.01, 0.0, 0.03), (0.001, 0, 0, 0, 0.0025, 0, 0, 0, 0.0017))


class NotingArm:
    """An arm, its hand and its server: notes every change, and carries it out."""

    state = SimpleNamespace(
        q=[0.1] * 7,
        m_ee=HAND.mass,
        F_x_Cee=HAND.center_of_mass,
        I_ee=HAND.inertia,
        F_T_NE=IDENTITY,
        robot_mode=RobotMode.IDLE,
    )

    def __init__(self):
        self.changes = []

    def change(self, action):
        action()
        return done()

    def open_or_close(self, *, is_open):
        self.changes.append(("fci", is_open))
        return done()

    def simulation(self):
        return self

    def set_brakes(self, *, closed):
        self.changes.append(("brakes", closed))

    def set_mounted(self, load, frame):
        self.changes.append(("end effector", load, frame))

    def homing(self):
        self.changes.append(("home",))


def done():
    """Return the future of a change that has been made."""
    future = Future()
    future.set_result(None)
    return future


class Clock:
    """A clock that is set."""

    seconds = 100.0

    def __call__(self):
        return self.seconds


def new_desk():
    """Return a Desk with closed brakes and without FCI."""
    arm = NotingArm()
    desk = Desk(arm, arm, arm, "fr3", now=Clock())
    desk.are_brakes_closed, desk.is_fci_active = True, False
    return desk


def client_of(url, auth=("ada", "secret")):
    """Return a client; by default one that sends name and password."""
    return httpx.Client(base_url=url, verify=False, auth=auth)


def take(client, owner="ada", timeout=0):
    """Take control; return the header of the requests that need it."""
    body = {"owner": owner, "timeout": timeout}
    answer = client.post("/api/system/control-token:take", json=body)
    assert answer.status_code == 200, answer.text
    return {"X-Control-Token": answer.json()["token"]}
