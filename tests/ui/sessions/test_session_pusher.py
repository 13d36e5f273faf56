"""Pushes for sessions."""

import asyncio

import pytest

from station.client import ApiError
from station.ui.sessions.session_access import SessionPusher
from station.ui.sessions.sessions import Role, Sessions
from station.wire import ExternalForce

PUSH = ExternalForce(link="panda_hand", force=[0.0, 0.0, 5.0])


class _Client:
    """Stands for the station's client; notes who pushes."""

    def __init__(self):
        self.acting_for = None
        self.pushed = []

    def robot(self, arm_id):
        self.arm_id = arm_id
        return self

    async def apply_force(self, push):
        self.pushed.append((self.acting_for, self.arm_id, push))

    async def close(self):
        self.pushed.append("closed")


class _Access:
    def __init__(self):
        self.client = _Client()
        self.made = 0

    def client_of(self, _):
        self.made += 1
        return self.client

    def renew(self, client, session):
        client.acting_for = session.key


def test_each_push_is_of_the_session_that_pulls():
    access, sessions = _Access(), Sessions()
    first, second = sessions.open(Role.OPERATOR), sessions.open(Role.OPERATOR)
    pusher = SessionPusher(access, sessions)

    async def push():
        await pusher(first.key, "left", PUSH)
        await pusher(second.key, "right", PUSH)
        await pusher.close()

    asyncio.run(push())
    assert access.made == 1
    assert access.client.pushed == [
        (first.key, "left", PUSH),
        (second.key, "right", PUSH),
        "closed",
    ]


@pytest.mark.parametrize("role", [Role.VIEWER, None])
def test_viewers_and_strangers_push_nothing(role):
    access, sessions = _Access(), Sessions()
    key = "nobody" if role is None else sessions.open(role).key
    pusher = SessionPusher(access, sessions)
    with pytest.raises(ApiError, match="logged-in operator"):
        asyncio.run(pusher(key, "panda", PUSH))
    assert access.client.pushed == []
