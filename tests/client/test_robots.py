"""What the clients of arm, gripper and simulation ask."""

import pytest

from station.wire import ExternalForce, Fault, Load
from tests.client.recorder import Recorder

REPORT = {
    "arm_id": "panda",
    "robot_mode": "idle",
    "connected": True,
    "errors": [],
    "remedy": "",
}
ANSWER = {**REPORT, "restarted": [], "records": [], "faults": []}
LOAD = {"mass": 1.0, "F_x_center_load": [0.0] * 3, "load_inertia": [0.0] * 9}
REQUESTS = [
    ("errors", (), "GET", "errors", None),
    ("recover", (), "POST", "error_recovery", {"restart": "none"}),
    ("recover", ("previous",), "POST", "error_recovery", {"restart": "previous"}),
    ("log", (), "GET", "log", None),
    ("faults", (), "GET", "faults", None),
    ("clear_faults", (), "DELETE", "faults", None),
    ("connect", (), "POST", "connect", None),
    ("disconnect", (), "POST", "disconnect", None),
    (
        "set_joint_impedance",
        ([1.0] * 7,),
        "PUT",
        "joint_impedance",
        {"joint_stiffness": [1.0] * 7},
    ),
    (
        "set_cartesian_impedance",
        ([1.0] * 6,),
        "PUT",
        "cartesian_impedance",
        {"cartesian_stiffness": [1.0] * 6},
    ),
    ("set_EE_frame", ([1.0] * 16,), "PUT", "ee_frame", {"NE_T_EE": [1.0] * 16}),
    ("set_K_frame", ([1.0] * 16,), "PUT", "k_frame", {"EE_T_K": [1.0] * 16}),
    ("set_load", (Load(**LOAD),), "PUT", "load", LOAD),
    (
        "apply_force",
        (ExternalForce(link="hand"),),
        "POST",
        "external_force",
        {"link": "hand"},
    ),
    ("inject", (Fault(kind="collision"),), "POST", "faults", {"kind": "collision"}),
]


@pytest.mark.parametrize(("name", "arguments", "method", "rest", "body"), REQUESTS)
def test_every_method_asks_its_route(name, arguments, method, rest, body):
    recorder = Recorder(ANSWER)

    recorder.run(lambda client: getattr(client.robot("panda"), name)(*arguments))

    assert recorder.requests == [(method, f"/api/v1/robots/panda/{rest}", body)]


@pytest.mark.parametrize(
    ("name", "route"), [("user_stop", "user_stop"), ("guiding", "guiding")]
)
@pytest.mark.parametrize("pressed", [True, False])
def test_buttons_are_pressed_and_released(name, route, pressed):
    recorder = Recorder(REPORT)

    recorder.run(lambda client: getattr(client.robot("panda"), name)(pressed=pressed))

    path = f"/api/v1/robots/panda/{route}"
    assert recorder.requests == [("POST", path, {"pressed": pressed})]


def test_a_model_is_asked_for_a_frame():
    matrices = ["mass", "coriolis", "gravity", "pose", "zero_jacobian", "body_jacobian"]
    recorder = Recorder({"frame": "flange", **{name: [] for name in matrices}})

    found = recorder.run(lambda client: client.robot("a/b").model("flange"))

    assert found.frame == "flange"
    path = "/api/v1/robots/a%2Fb/model?frame=flange"
    assert recorder.requests == [("GET", path, None)]


SIMULATION = {"paused": True, "real_time_factor": 1.0, "time": 0.0, "steps_due": 0}
OF_SIMULATION = [
    ("state", (), "GET", "", None),
    ("pause", (), "PATCH", "", {"paused": True}),
    ("resume", (), "PATCH", "", {"paused": False}),
    ("set_real_time_factor", (0.5,), "PATCH", "", {"real_time_factor": 0.5}),
    ("step", (7,), "POST", "/step", {"n": 7}),
    ("reset", (), "POST", "/reset", {"joint_positions": {}}),
    ("reset", ({"j": 1.0},), "POST", "/reset", {"joint_positions": {"j": 1.0}}),
]


@pytest.mark.parametrize(("name", "arguments", "method", "rest", "body"), OF_SIMULATION)
def test_every_simulation_method_asks_its_route(name, arguments, method, rest, body):
    recorder = Recorder(SIMULATION)

    found = recorder.run(lambda client: getattr(client.simulation, name)(*arguments))

    assert found.paused
    assert recorder.requests == [(method, f"/api/v1/simulation{rest}", body)]
