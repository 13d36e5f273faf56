"""A Desk with an arm that notes what it was asked for, and clients of its REST."""

from concurrent.futures import Future

import httpx

from station.hw.franka.arm.franka_kinematics import IDENTITY
from station.hw.franka.arm.load import Load
from station.hw.franka.fci.desk.desk_state import (
    MOUNTED,
    NO_END_EFFECTOR,
    Desk,
    profile_of,
)

HAND = Load(0.73, (-0.01, 0.0, 0.03), (0.001, 0, 0, 0, 0.0025, 0, 0, 0, 0.0017))


class NotingArm:
    """Notes every change, and has carried it out at once."""

    kind = "FR3"

    def __init__(self):
        self.changes = []

    def joints(self):
        return [0.1] * 7

    def set_brakes(self, *, closed):
        return self._note("brakes", closed)

    def set_fci(self, *, active):
        return self._note("fci", active)

    def set_end_effector(self, load, frame):
        return self._note("end effector", load, frame)

    def home_gripper(self):
        return self._note("home")

    def _note(self, *change):
        self.changes.append(change)
        done = Future()
        done.set_result(None)
        return done


class Clock:
    """A clock that is set."""

    seconds = 100.0

    def __call__(self):
        return self.seconds


def new_desk():
    profiles = {
        MOUNTED: profile_of("Mounted", HAND, IDENTITY),
        NO_END_EFFECTOR: profile_of("No End Effector", Load(), IDENTITY),
    }
    return Desk(NotingArm(), profiles, now=Clock())


def client_of(url, auth=("ada", "secret")):
    """Return a client; by default one that sends name and password."""
    return httpx.Client(base_url=url, verify=False, auth=auth)


def take(client, owner="ada", timeout=0):
    """Take control; return the header of the requests that need it."""
    body = {"owner": owner, "timeout": timeout}
    answer = client.post("/api/system/control-token:take", json=body)
    assert answer.status_code == 200, answer.text
    return {"X-Control-Token": answer.json()["token"]}
