"""The requests of aiofranka and franky, in their order and with their bodies.

Source: aiofranka 0.9.0 server.py, client.py, tools.py; franky-control 2.0.0 desk.py.
"""

import asyncio
import base64
import json
import os
import ssl
import subprocess
import sys
from concurrent.futures import Future
from queue import SimpleQueue

import httpx
import pytest
from websockets.asyncio.client import connect
from websockets.exceptions import InvalidStatus

from station.core.errors import ArmCommandError
from station.web.limited_server import SocketProtocol
from tests.hw.franka.fci.desk.desk_bench import HAND, take
from tests.waiting import PATIENCE, wait_until


def test_unlocking_of_the_present_interface(desk, client):
    """`aiofranka.unlock` and `lock`, `franky.Desk`."""
    assert client.get("/api/safety/self-tests").json()["status"] == "OK"
    assert client.get("/api/system/operating-mode").json() == {"status": "Execution"}
    control = take(client, timeout=15)
    assert client.get("/api/system/control-token").json()["owner"] == "ada"
    assert client.get("/api/safety/recovery").json() == {}
    for path in ("/api/arm/joints:unlock", "/api/fci:activate"):
        assert client.post(path, headers=control).status_code == 200
    assert desk.arm.changes == [("brakes", False), ("fci", True)]
    assert client.get("/api/fci").json() == {"status": "Active"}
    joints = client.get("/api/arm/joints").json()
    assert [joint["brakeStatus"] for joint in joints] == ["Unlocked"] * 7
    for path in ("/api/fci:deactivate", "/api/arm/joints:lock"):
        assert client.post(path, headers=control).status_code == 200
    assert desk.arm.changes[2:] == [("fci", False), ("brakes", True)]
    answer = client.post("/api/system/control-token:release", headers=control)
    assert answer.status_code == 204
    assert client.get("/api/system/control-token").json() == {}
    assert client.get("/api/arm").json() == {"status": "Connected", "armType": "FR3"}
    assert client.get("/api/system").json()["operatingMode"] == {"status": "Execution"}


def test_unlocking_of_the_old_interface(desk, old):
    """`franky.DeskWebSession`, `aiofranka.client.FrankaLockUnlock`."""
    assert old.get("/admin/api/control-token").json()["activeToken"] is None
    path, body = "/admin/api/control-token/request", {"requestedBy": "ada"}
    asked = old.post(path, json=body).json()
    control = {"X-Control-Token": asked["token"]}
    status = old.get("/admin/api/system-status").json()
    assert status["controlToken"]["activeToken"]["id"] == asked["id"]
    assert status["derived"]["operatingMode"] == "Execution"
    assert status["safety"]["brakeState"] == ["Locked"] * 7
    form = {"content-type": "application/x-www-form-urlencoded"}
    old.post("/desk/api/joints/unlock", headers={**control, **form})
    secret = base64.b64encode(asked["token"].encode()).decode()
    old.post("/desk/api/system/fci", headers=control, data={"token": secret})
    old.post("/desk/api/gripper/homing", headers=control)
    old.post("/desk/api/robot/close-brakes", headers=control, files={"force": "true"})
    old.post("/admin/api/control-token/fci", json={"token": asked["token"]})
    assert desk.arm.changes == [
        ("brakes", False),
        ("fci", True),
        ("home",),
        ("brakes", True),
        ("fci", True),
    ]
    assert old.get("/admin/api/control-token").json()["fciActive"] is True
    old.post("/desk/api/operating-mode/programming", headers=control)
    assert desk.mode == "Programming"
    answer = old.request("DELETE", "/admin/api/control-token", json=asked)
    assert answer.status_code == 200
    assert desk.token is None
    assert old.post("/admin/api/logout").status_code == 200


PANDA_PYTHON = """
import sys
import panda_py

desk = panda_py.Desk(sys.argv[1], "ada", "secret")
assert desk.has_control()
desk.unlock()
desk.activate_fci()
desk.deactivate_fci()
desk.lock()
# The token is kept in the user's home for other programs.
assert panda_py.Desk(sys.argv[1], "bob", "secret").has_control()
desk.release_control()
assert desk.take_control()
desk.reboot()
"""


def test_unlocking_by_panda_python(desk, url, tmp_path):
    """Its class `Desk`, unmodified, in a process of its own: it closes nothing."""
    pytest.importorskip("panda_py")
    # It trusts any certificate, unless a variable names those to trust.
    names = os.environ.keys() - {"REQUESTS_CA_BUNDLE", "CURL_CA_BUNDLE"}
    environment = {name: os.environ[name] for name in names} | {"HOME": str(tmp_path)}
    address = url.removeprefix("https://")

    subprocess.run(
        [sys.executable, "-c", PANDA_PYTHON, address], check=True, env=environment
    )

    assert desk.arm.changes == [
        ("brakes", False),
        ("fci", True),
        ("fci", False),
        ("brakes", True),
        *(("fci", False), ("brakes", True)),  # the reboot
    ]
    assert desk.token is None


def test_second_client_waits_and_is_told_of_the_timeout(client):
    take(client, "ben")
    body = {"owner": "ada", "timeout": 0}
    answer = client.post("/api/system/control-token:take", json=body)
    assert answer.status_code == 424
    assert answer.json() == {"code": "Timeout", "message": "ben has control."}


def test_client_that_goes_while_it_waits_gets_no_control(desk, client):
    control = take(client, "ben")
    body = {"owner": "ada", "timeout": 60}
    with pytest.raises(httpx.ReadTimeout):
        client.post("/api/system/control-token:take", json=body, timeout=0.5)
    assert wait_until(lambda: not desk.waiting)
    client.post("/api/system/control-token:release", headers=control)
    assert desk.token is None


@pytest.mark.parametrize(
    ("header", "status", "code"),
    [({}, 400, "MissingControlToken"), ({"X-Control-Token": "x"}, 423, None)],
)
def test_changes_need_control(desk, client, header, status, code):
    take(client)
    answer = client.post("/api/arm/joints:unlock", headers=header)
    assert answer.status_code == status
    assert code in (None, answer.json()["code"])
    assert desk.arm.changes == []


@pytest.mark.parametrize("path", ["/api/system", "/admin/api/system-status"])
@pytest.mark.parametrize("told", [None, "Basic ?", "Basic Ong="])
def test_requests_need_a_name(stranger, path, told):
    headers = {} if told is None else {"Authorization": told}
    assert stranger.get(path, headers=headers).status_code == 401
    login = stranger.post("/admin/api/login", json={"password": "x"})
    assert login.status_code == 401


def test_end_effectors_are_kept_and_count_when_they_are_activated(desk, client):
    """`aiofranka.save_tool`, `load_tool`, `remove_tool`."""
    control, path = take(client), "/admin/api/end-effector/profiles"
    (mounted, nothing) = client.get(path).json()
    assert (mounted["active"], nothing["id"]) == (True, "ee-no-profile")
    pen = {**mounted, "name": "pen"}
    pen["inertial"] = {**pen["inertial"], "mass": 0.2}
    refused = client.post(path, json=pen)
    assert refused.status_code == 400
    assert "token" in refused.text.lower()  # it then asks again with the token
    name = client.post(path, json=pen, headers=control).json()["id"]
    client.put(f"{path}/active", json=name, headers=control)
    load = desk.arm.changes[-1][1]
    assert (load.mass, load.center_of_mass) == (0.2, HAND.center_of_mass)
    assert client.get(f"{path}/active").json()["id"] == name
    client.put(f"{path}/active", json="ee-no-profile", headers=control)
    answer = client.delete(f"{path}/{name}", headers=control)
    assert answer.status_code == 204
    assert len(client.get(path).json()) == 2


def test_configuration_changes_the_end_effector(desk, client):
    """`aiofranka.set_configuration`."""
    control = take(client)
    told = client.get("/api/configuration").json()
    end_effector = told["endEffectorConfiguration"]["endEffector"]
    end_effector["params"]["mass"] = 0.5
    answer = client.patch("/api/configuration", json=told, headers=control)
    assert answer.status_code == 204
    assert desk.arm.changes[-1][1].mass == 0.5
    assert client.get("/api/configuration").json() == told
    for other in ({"network": {}}, {"endEffectorConfiguration": []}):
        wrong = client.patch("/api/configuration", json=other, headers=control)
        assert wrong.status_code == 424


def test_change_that_the_arm_refuses_is_told_and_changes_nothing(
    desk, client, monkeypatch
):
    def change(action):
        future = Future()
        try:
            future.set_result(action())
        except ArmCommandError as error:
            future.set_exception(error)
        return future

    def refuse(_load, _frame):
        raise ArmCommandError("The arm moves.")

    monkeypatch.setattr(desk.arm, "change", change)
    monkeypatch.setattr(desk.arm, "set_mounted", refuse)
    control, path = take(client), "/admin/api/end-effector/profiles/active"
    answer = client.put(path, json="ee-no-profile", headers=control)
    assert answer.status_code == 424
    assert "The arm moves." in answer.json()["message"]
    assert client.get(path).json()["id"] == "ee-mounted"


@pytest.mark.parametrize("body", [b"{", b"[]"])
def test_body_that_is_no_object_is_refused(client, body):
    answer = client.post("/api/system/control-token:take", content=body)
    assert (answer.status_code, answer.json()["code"]) == (400, "InvalidArgument")


@pytest.mark.parametrize("timeout", ["soon", [1.0]])
def test_timeout_that_is_no_number_is_refused_and_takes_no_control(
    desk, client, timeout
):
    body = {"owner": "ada", "timeout": timeout}
    answer = client.post("/api/system/control-token:take", json=body)
    assert (answer.status_code, answer.json()["code"]) == (400, "InvalidArgument")
    assert desk.token is None


def test_what_a_simulated_arm_has_not_is_refused_in_words(client):
    answer = client.post("/api/system:shutdown")
    assert answer.status_code == 424
    assert answer.json()["message"] == "A simulated arm has no /api/system:shutdown."


def listen(url, path, cookie=None):
    """Return a WebSocket of Desk; in Python 3.11 one with TLS is for one thread."""
    context = ssl.create_default_context()
    context.check_hostname, context.verify_mode = False, ssl.CERT_NONE
    headers = {} if cookie is None else {"Cookie": f"authorization={cookie}"}
    address = f"{url.replace('https', 'wss')}/desk/api/{path}"
    return connect(address, ssl=context, additional_headers=headers)


def test_joints_are_told_and_buttons_are_not_pressed(url):
    async def hear(path, seconds):
        async with listen(url, path, "x") as socket, asyncio.timeout(seconds):
            return json.loads(await socket.recv())

    async def knock():
        await listen(url, "navigation/events")

    told = asyncio.run(hear("robot/configuration", PATIENCE))
    assert told == {"jointAngles": [0.1] * 7}
    with pytest.raises(TimeoutError):
        asyncio.run(hear("navigation/events", 0.0))
    with pytest.raises(InvalidStatus, match="403"):
        asyncio.run(knock())


def test_a_client_that_has_just_closed_does_not_disturb_the_end(url, monkeypatch):
    outcomes = SimpleQueue()
    original = SocketProtocol.handle_close

    def end_at_once(self, event):
        original(self, event)
        outcomes.put(self.shutdown())

    async def open_and_close():
        async with listen(url, "navigation/events", "x"):
            pass

    monkeypatch.setattr(SocketProtocol, "handle_close", end_at_once)
    asyncio.run(open_and_close())
    assert outcomes.get(timeout=PATIENCE) is None
