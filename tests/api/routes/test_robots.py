"""Arms over HTTP."""

import pytest

from station.client import ApiError
from station.wire import (
    ExternalForce,
    Fault,
    ForceTorqueCollisionBehavior,
    FullCollisionBehavior,
    Load,
)
from tests.franka_station import JOINTS, make_franka_station

IDENTITY = [1.0, 0, 0, 0, 0, 1.0, 0, 0, 0, 0, 1.0, 0, 0, 0, 0, 1.0]
NOMINAL = {
    "lower_torque_thresholds_nominal": [20.0] * 7,
    "upper_torque_thresholds_nominal": [40.0] * 7,
    "lower_force_thresholds_nominal": [20.0] * 6,
    "upper_force_thresholds_nominal": [40.0] * 6,
}


@pytest.fixture
def station():
    return make_franka_station()


@pytest.fixture
def panda(client):
    return client.robot("panda")


def test_status_lists_the_arm(client):
    (arm,) = client.status().robots

    assert (arm.arm_id, arm.robot_mode, arm.remedy) == ("panda", "idle", "")
    assert client.robots() == [arm]


def test_state_has_every_field(panda):
    state = panda.state()

    assert state.robot_mode == "idle"
    assert len(state.O_T_EE) == 16
    assert state.current_errors == []
    assert state.elbow[1] == -1.0


def test_model_is_that_of_the_frame(panda):
    assert panda.model("flange").pose[14] == pytest.approx(0.590282, abs=1e-5)
    assert panda.model().frame == "end_effector"


def test_unknown_arm_and_frame_are_refused(client, operator):
    with pytest.raises(ApiError, match="no arm 'left'") as caught:
        client.robot("left").state()
    assert caught.value.status == 404
    answer = operator.get("/api/v1/robots/panda/model?frame=nose")
    assert answer.status_code == 422


def test_services_accept_values_within_their_ranges(panda):
    panda.set_joint_impedance([3000.0] * 7)
    panda.set_cartesian_impedance([2000.0] * 3 + [200.0] * 3)
    panda.set_EE_frame(IDENTITY)
    panda.set_K_frame(IDENTITY)
    panda.set_load(Load(mass=0.1, F_x_center_load=[0, 0, 0.1], load_inertia=[0] * 9))
    panda.set_force_torque_collision_behavior(ForceTorqueCollisionBehavior(**NOMINAL))
    full = {key.replace("nominal", "acceleration"): v for key, v in NOMINAL.items()}
    panda.set_full_collision_behavior(FullCollisionBehavior(**NOMINAL, **full))

    assert panda.state().m_load == 0.1


@pytest.mark.parametrize("stiffness", [[-1.0] * 7, [1e6] * 7])
def test_service_out_of_range_is_refused(panda, stiffness):
    with pytest.raises(ApiError, match="joint_stiffness") as caught:
        panda.set_joint_impedance(stiffness)
    assert caught.value.status == 422


def test_service_is_refused_while_the_arm_moves(client, panda):
    client.switch_controllers(start=["arm"])
    with pytest.raises(ApiError, match="while a motion runs") as caught:
        panda.set_joint_impedance([3000.0] * 7)
    assert (caught.value.status, caught.value.code) == (409, "arm_command_refused")


def test_collision_shows_in_the_status_and_is_recovered_from(client, panda, station):
    client.switch_controllers(start=["arm"])
    panda.inject(Fault(kind="collision", cycles=30))
    station.loop.step(200)

    (arm,) = client.status().robots
    assert arm.robot_mode == "reflex"
    assert "cartesian_reflex" in {error.name for error in arm.errors}
    assert "recover" in arm.remedy
    with pytest.raises(ApiError, match="mode reflex"):
        client.switch_controllers(start=["arm"])
    recovered = panda.recover("previous")
    assert (recovered.robot_mode, recovered.restarted) == ("move", ["arm"])
    assert panda.errors().remedy == ""


@pytest.mark.parametrize("recover", ["recover", "recover_all"])
def test_a_recovery_starts_the_controllers_that_it_names(
    client, panda, station, recover
):
    kind = "position_controllers/JointGroupPositionController"
    client.load_controller("other", kind, {"joints": JOINTS})
    client.switch_controllers(start=["arm"])
    panda.inject(Fault(kind="collision", cycles=30))
    station.loop.step(200)
    act = getattr(panda if recover == "recover" else client, recover)

    with pytest.raises(ApiError, match="'nobody'") as caught:
        act(["other", "nobody"])
    assert (caught.value.status, panda.errors().robot_mode) == (404, "reflex")
    assert act(["other"]).restarted == ["other"]
    assert client.controller("arm").state == "stopped"
    assert client.controller("other").state == "running"


@pytest.mark.parametrize("restart", ["all", 1, None, {"arm": True}])
def test_a_recovery_without_sense_is_refused(operator, restart):
    path = "/api/v1/robots/panda/error_recovery"
    answer = operator.post(path, json={"restart": restart})

    problem = answer.json()
    assert answer.status_code == 422
    assert [one["field"] for one in problem["errors"]] == ["body/restart"]
    assert "'none', 'previous' or a list of names" in problem["detail"]


def test_torques_and_a_motion_of_two_controllers_share_the_arm(client, panda, station):
    kinds = {
        "torques": ("effort_controllers/JointGroupEffortController", "joints", JOINTS),
        "pose": (
            "franka_example_controllers/CartesianPoseExampleController",
            "arm_id",
            "panda",
        ),
    }
    for name, (kind, key, value) in kinds.items():
        client.load_controller(name, kind, {key: value})
    client.switch_controllers(start=list(kinds))
    start = panda.state()
    station.loop.step(1_500)

    states = {c.name: c.state for c in client.controllers() if c.name in kinds}
    assert set(states.values()) == {"running"}
    state = panda.state()
    assert (state.robot_mode, state.current_errors) == ("move", [])
    # What is desired moves on its arc; no torque lets the arm do so.
    assert start.O_T_EE_d[12] - state.O_T_EE_d[12] > 0.01
    assert state.O_T_EE[12] == pytest.approx(start.O_T_EE[12], abs=1e-3)
    with pytest.raises(ApiError, match="joint motion and a Cartesian") as caught:
        client.switch_controllers(start=["arm"])
    assert caught.value.status == 409


def test_user_stop_is_pressed_and_released(panda):
    assert panda.user_stop(pressed=True).remedy == "release the user stop"
    assert panda.user_stop(pressed=False).robot_mode == "idle"


def test_connection_is_given_up_and_taken(panda):
    assert panda.disconnect().connected is False
    assert panda.connect().connected is True


def test_push_is_felt(panda, station):
    panda.apply_force(ExternalForce(link="panda_hand", force=[0, 0, 5], duration=1))
    station.loop.step(300)

    assert panda.state().O_F_ext_hat_K[2] == pytest.approx(-5.0, rel=0.05)
    with pytest.raises(ApiError, match="no body 'nose'"):
        panda.apply_force(ExternalForce(link="nose"))


def test_push_that_is_too_strong_is_refused_with_its_field(operator):
    push = {"link": "panda_hand", "force": [0.0, 0.0, 1e308]}
    answer = operator.post("/api/v1/robots/panda/external_force", json=push)

    assert answer.status_code == 422
    assert "at most 500 N" in answer.json()["detail"]
    assert [one["field"] for one in answer.json()["errors"]] == ["body/force"]


def test_viewer_may_look_and_not_touch(http):
    http.headers["Authorization"] = "Bearer viewer-token"
    assert http.get("/api/v1/robots/panda/state").status_code == 200
    for what in ("error_recovery", "connect", "disconnect"):
        assert http.post(f"/api/v1/robots/panda/{what}").status_code == 403


def test_log_of_the_last_motion_is_kept_for_looking_at(client, panda, station):
    client.switch_controllers(start=["arm"])
    station.loop.step(100)
    assert panda.log() == []
    panda.inject(Fault(kind="collision", cycles=30))
    station.loop.step(200)

    records = panda.log()
    assert len(records) == 50
    assert records[-1].time > records[0].time
    assert len(records[0].command) == 7
    client.recover_all()
    assert panda.log() == records


def test_all_arms_are_recovered_at_once(client, panda, station):
    client.switch_controllers(start=["arm"])
    panda.inject(Fault(kind="collision", cycles=30))
    station.loop.step(200)

    answer = client.recover_all("previous")

    assert [(arm.arm_id, arm.robot_mode) for arm in answer.robots] == [
        ("panda", "move")
    ]
    assert answer.restarted == ["arm"]
    panda.user_stop(pressed=True)
    with pytest.raises(ApiError, match="user stop is pressed") as caught:
        client.recover_all()
    assert caught.value.status == 409


def test_faults_are_listed_and_cleared(panda):
    panda.inject(Fault(kind="stuck_joint", cycles=1000, joint=4))
    (fault,) = panda.faults()
    assert (fault.kind, fault.joint) == ("stuck_joint", 4)
    assert panda.clear_faults() == []
    with pytest.raises(ApiError, match="at most 500") as caught:
        panda.inject(Fault(kind="delayed_cycle", cycles=10_000))
    assert caught.value.status == 422


def test_a_push_is_listed_as_a_collision_until_it_is_ended(panda, station):
    force = [0.0, 0.0, 5.0]
    panda.apply_force(ExternalForce(link="panda_hand", force=force, duration=60.0))
    station.loop.step(300)
    (push,) = panda.faults()
    assert (push.kind, push.cycles) == ("collision", 60_000 - 300)
    assert panda.clear_faults() == []
    station.loop.step(300)
    assert panda.state().O_F_ext_hat_K[2] == pytest.approx(0.0, abs=0.05)


def test_arm_is_guided_by_hand(panda, station):
    assert panda.guiding(pressed=True).robot_mode == "guiding"
    push = ExternalForce(
        link="panda_hand",
        force=[0, 15, 0],
        frame="panda_link0",
        point=[0, 0, 0.05],
        duration=0.3,
    )
    panda.apply_force(push)
    station.loop.step(300)
    assert panda.state().O_T_EE[13] > 0.01
    assert panda.guiding(pressed=False).robot_mode == "idle"


def test_blind_sensor_reads_null_and_no_controller_is_started(client, panda, station):
    panda.inject(Fault(kind="nan_sensor", cycles=1000, joint=2))
    station.loop.step(10)

    joints = client.joint_states()
    assert joints.position[joints.name.index("panda_joint2")] is None
    assert panda.state().q[1] is None
    with pytest.raises(ApiError, match="joint2 reads nan") as caught:
        client.switch_controllers(start=["arm"])
    assert caught.value.status == 409
    panda.clear_faults()
    station.loop.step(2)
    client.switch_controllers(start=["arm"])


@pytest.mark.parametrize(
    ("route", "body", "fields"),
    [
        (
            "joint_impedance",
            {"joint_stiffness": [100.0, -1.0, 100.0, 100.0, 100.0, 100.0, 2e4]},
            ["body/joint_stiffness/1", "body/joint_stiffness/6"],
        ),
        (
            "cartesian_impedance",
            {"cartesian_stiffness": [2000.0] * 6},
            [f"body/cartesian_stiffness/{axis}" for axis in (3, 4, 5)],
        ),
        ("ee_frame", {"NE_T_EE": [1.0] * 16}, ["body/NE_T_EE"]),
        ("k_frame", {"EE_T_K": [0.0] * 16}, ["body/EE_T_K"]),
        (
            "load",
            {"mass": -1.0, "F_x_center_load": [0.0] * 3, "load_inertia": [0.0] * 9},
            ["body/mass"],
        ),
        (
            "load",
            {"mass": 500.0, "F_x_center_load": [0.0] * 3, "load_inertia": [0.0] * 9},
            ["body/mass"],
        ),
        (
            "load",
            {
                "mass": 1.0,
                "F_x_center_load": [1e308, 1e308, 0.0],
                "load_inertia": [0.0] * 9,
            },
            ["body/F_x_center_load"],
        ),
        (
            "load",
            {
                "mass": 1.0,
                "F_x_center_load": [0.0] * 3,
                "load_inertia": [-1.0] + [0.0] * 8,
            },
            ["body/load_inertia"],
        ),
        (
            "force_torque_collision_behavior",
            {**NOMINAL, "lower_force_thresholds_nominal": [50.0] * 6},
            ["body/lower_force_thresholds_nominal"],
        ),
        ("joint_impedance", {"joint_stiffness": [1.0] * 6}, ["body/joint_stiffness"]),
    ],
)
def test_refused_setting_names_its_fields(operator, route, body, fields):
    answer = operator.put(f"/api/v1/robots/panda/{route}", json=body)
    assert answer.status_code == 422
    assert [error["field"] for error in answer.json()["errors"]] == fields


def test_thresholds_of_the_phase_decide(client, panda, station):
    strict = {**NOMINAL}
    loose = {
        key.replace("nominal", "acceleration"): [90.0] * len(v)
        for key, v in NOMINAL.items()
    }
    for key in strict:
        if key.startswith("lower"):
            strict[key] = [5.0] * len(strict[key])
        else:
            strict[key] = [10.0] * len(strict[key])
    panda.set_full_collision_behavior(FullCollisionBehavior(**strict, **loose))
    # At rest the nominal ones hold: 15 N are too much.
    panda.apply_force(ExternalForce(link="panda_hand", force=[0, 15, 0], duration=0.2))
    station.loop.step(100)
    assert panda.errors().robot_mode == "reflex"
    panda.clear_faults()
    panda.recover()
    kind = "velocity_controllers/JointGroupVelocityController"
    joints = [f"panda_joint{number}" for number in range(1, 8)]
    client.load_controller("speed", kind, {"joints": joints})
    client.switch_controllers(start=["speed"])
    # While the desired motion accelerates the others do: the same push is no collision.
    for cycle in range(150):
        client.command("speed", [0.003 * cycle, *[0.0] * 6])
        if cycle == 50:
            push = ExternalForce(link="panda_hand", force=[0, 15, 0], duration=0.05)
            panda.apply_force(push)
        station.loop.step()
    assert panda.errors().robot_mode == "move"
