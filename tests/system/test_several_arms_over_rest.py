"""Two and four arms in one world, as a program sees them that speaks REST alone."""

from pathlib import Path

import pytest

from station.api.app import create_app
from station.api.auth import Authenticator
from station.app.composition import compose
from station.client import ApiError, StationClient
from station.config import load_config
from station.wire import ExternalForce, GripperMoveRequest, Load
from tests.api.conftest import OPERATOR, URL, VIEWER, AppTransport

EXAMPLES = Path(__file__).parents[2] / "examples"
CONTROLLERS = {
    "dual_panda": ["dual_arm_cartesian_impedance_example_controller"],
    "four_pandas": [f"panda_{number}_position" for number in range(1, 5)],
}


@pytest.fixture(params=list(CONTROLLERS), scope="module")
def arms(request):
    """Return a client, the loop, the names of the arms, and controllers of all."""
    composed = compose(load_config(EXAMPLES / f"{request.param}.yaml"))
    assert not composed.not_loaded
    app = create_app(composed.station, Authenticator(OPERATOR, VIEWER))
    controllers = CONTROLLERS[request.param]
    names = [f"panda_{n}" for n in range(1, 3 if len(controllers) == 1 else 5)]
    with StationClient(URL, OPERATOR, transport=AppTransport(app)) as client:
        composed.station.loop.step(10)
        client.switch_controllers(start=controllers)
        composed.station.loop.step(500)
        yield client, composed.station.loop, names, controllers


def modes(client, names) -> list[str]:
    return [client.robot(name).state().robot_mode for name in names]


def test_every_arm_moves_under_torques(arms):
    client, _, names, _ = arms
    assert modes(client, names) == ["move"] * len(names)


def test_every_arm_has_a_gripper_of_its_own(arms):
    client, loop, names, _ = arms
    client.robot(names[-1]).gripper.move(GripperMoveRequest(width=0.03, speed=0.1))
    loop.step(1500)
    widths = [client.robot(name).gripper.state().width for name in names]
    assert widths[-1] == pytest.approx(0.03, abs=1e-3)
    assert widths[:-1] == pytest.approx([0.08] * (len(names) - 1), abs=1e-3)


def test_error_of_one_arm_stops_all_and_they_recover_together(arms):
    """And while nothing moves, a service changes one arm alone."""
    client, loop, names, controllers = arms
    push = ExternalForce(
        link=f"{names[1]}_link5", force=[0.0, 0.0, 300.0], duration=0.2
    )
    client.robot(names[1]).apply_force(push)
    loop.step(400)

    others = [name for name in names if name != names[1]]
    assert modes(client, [names[1]]) == ["reflex"]
    assert set(modes(client, others)) == {"idle"}
    assert {client.controller(one).state for one in controllers} == {"stopped"}
    with pytest.raises(ApiError, match=f"'{names[1]}' is in mode reflex"):
        client.switch_controllers(start=controllers)

    load = Load(mass=0.5, F_x_center_load=[0.0] * 3, load_inertia=[0.0] * 9)
    client.robot(names[0]).set_load(load)
    assert [client.robot(name).state().m_load for name in names][:2] == [0.5, 0.0]
    client.robot(names[0]).set_load(load.model_copy(update={"mass": 0.0}))

    client.recover_all(restart="previous")
    loop.step(200)
    assert modes(client, names) == ["move"] * len(names)
    assert {client.controller(one).state for one in controllers} == {"running"}
