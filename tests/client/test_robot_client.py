"""One method per route of an arm."""

import pytest

from station.client.robot_client import RobotClient
from station.wire import ArmLog, ExternalForce, Fault, Faults, Load

CALLS = [
    ("state", (), "GET", "state"),
    ("model", ("flange",), "GET", "model?frame=flange"),
    ("errors", (), "GET", "errors"),
    ("recover", (), "POST", "error_recovery"),
    ("log", (), "GET", "log"),
    ("faults", (), "GET", "faults"),
    ("clear_faults", (), "DELETE", "faults"),
    ("connect", (), "POST", "connect"),
    ("disconnect", (), "POST", "disconnect"),
    ("set_joint_impedance", ([1.0] * 7,), "PUT", "joint_impedance"),
    ("set_cartesian_impedance", ([1.0] * 6,), "PUT", "cartesian_impedance"),
    ("set_EE_frame", ([1.0] * 16,), "PUT", "ee_frame"),
    ("set_K_frame", ([1.0] * 16,), "PUT", "k_frame"),
    (
        "set_load",
        (Load(mass=1.0, F_x_center_load=[0.0] * 3, load_inertia=[0.0] * 9),),
        "PUT",
        "load",
    ),
    ("apply_force", (ExternalForce(link="hand"),), "POST", "external_force"),
    ("inject", (Fault(kind="collision"),), "POST", "faults"),
]


@pytest.mark.parametrize(("name", "arguments", "method", "rest"), CALLS)
def test_method_asks_its_route(name, arguments, method, rest):
    sent = []
    answer = ArmLog(records=[]) if name == "log" else Faults(faults=[])

    getattr(RobotClient(lambda call: sent.append(call) or answer, "panda"), name)(
        *arguments
    )

    assert [(call.method, call.path) for call in sent] == [
        (method, f"/api/v1/robots/panda/{rest}")
    ]
