"""Robots from URDFs: from a controller's command to what the joints do."""

from math import degrees, inf, nan
from pathlib import Path

import pytest

from station.core.description.robot_files import load_robot_files
from station.core.errors import (
    HardwareInterfaceError,
    ParameterError,
    SwitchRefusedError,
)
from station.core.hardware.interfaces import (
    ActuatorStateInterface,
    EffortJointInterface,
    JointStateHandle,
    JointStateInterface,
    PositionJointInterface,
    VelocityJointInterface,
)
from station.core.hardware.robot_hw import ControllerInfo, InterfaceResources
from station.core.hardware.transmissions import (
    ActuatorToJointEffortInterface,
    ActuatorToJointPositionInterface,
    ActuatorToJointVelocityInterface,
    JointToActuatorStateInterface,
)
from station.core.parameters import Parameters, ParameterTree
from station.hw.mujoco.mujoco_robot_hw import MujocoRobotHW
from station.hw.urdf_loader import load_urdf

PERIOD = 0.001
UR5, PANDA = "example-robot-data:ur5", "example-robot-data:panda"
ROBOTS = Path(__file__).parents[3] / "examples" / "robots"
WRIST = str(ROBOTS / "differential_wrist.urdf")
LEG = str(ROBOTS / "four_bar_leg.urdf")
INTERFACES = {
    "position": PositionJointInterface,
    "velocity": VelocityJointInterface,
    "effort": EffortJointInterface,
}
FROM_ACTUATORS = {
    "position": ActuatorToJointPositionInterface,
    "velocity": ActuatorToJointVelocityInterface,
    "effort": ActuatorToJointEffortInterface,
}
# UR5 has no <safety_controller>: soft limits 0.1 rad before the hard ones.
UR5_SOFT_LIMITS = {
    name: {
        "has_soft_limits": True,
        "soft_lower_limit": -reach,
        "soft_upper_limit": reach,
        "k_position": 10.0,
        "k_velocity": 100.0,
    }
    for name, reach in (
        ("shoulder_pan_joint", 6.18),
        ("shoulder_lift_joint", 6.18),
        ("elbow_joint", 3.04),
        ("wrist_1_joint", 6.18),
        ("wrist_2_joint", 6.18),
        ("wrist_3_joint", 6.18),
    )
}


def make(reference: str = UR5, **parameters: object) -> MujocoRobotHW:
    robot = {"robot_description": reference, "floor": False, **parameters}
    tree = ParameterTree({"robot": robot})
    hw = MujocoRobotHW()
    hw.init(Parameters(tree), Parameters(tree, "robot"))
    return hw


def states(hw: MujocoRobotHW) -> dict[str, JointStateHandle]:
    return {handle.name: handle for handle in hw.get(JointStateInterface).handles()}


def claim(hw: MujocoRobotHW, quantity: str, *joints: str) -> list[ControllerInfo]:
    interface = INTERFACES[quantity].type_name
    claims = (InterfaceResources(interface, joints),)
    info = [ControllerInfo("controller", "test/Controller", claims)]
    hw.prepare_switch(info, [])
    hw.do_switch(info, [])
    return info


def drive(
    hw: MujocoRobotHW, quantity: str, commands: dict[str, float], cycles: int
) -> None:
    """Command anew each cycle, as a controller does: limits change the buffers."""
    interface = hw.get(INTERFACES[quantity])
    for _ in range(cycles):
        hw.read(0.0, PERIOD)
        for name, value in commands.items():
            interface.get_handle(name).set_command(value)
        hw.write(0.0, PERIOD)


def test_every_joint_takes_all_three_commands():
    hw = make()
    joints = [
        "shoulder_pan_joint",
        "shoulder_lift_joint",
        "elbow_joint",
        "wrist_1_joint",
        "wrist_2_joint",
        "wrist_3_joint",
    ]
    assert [handle.name for handle in hw.get(JointStateInterface).handles()] == joints
    for interface in INTERFACES.values():
        assert hw.get(interface).get_names() == sorted(joints)
        assert hw.get(interface).get_claims() == []


@pytest.mark.parametrize("gravity_compensation", [True, False])
def test_unclaimed_robot_holds_its_pose(gravity_compensation: bool):  # noqa: FBT001
    start = {"shoulder_lift_joint": -1.0, "elbow_joint": 1.0}
    hw = make(initial_positions=start, gravity_compensation=gravity_compensation)
    drive(hw, "effort", {}, 1000)
    for name, state in states(hw).items():
        # A servo of finite stiffness that knows its load.
        assert state.get_position() == pytest.approx(start.get(name, 0.0), abs=1e-5)


def test_joint_that_loses_its_controller_stops_and_stays():
    hw = make()
    info = claim(hw, "velocity", "wrist_3_joint")
    drive(hw, "velocity", {"wrist_3_joint": 2.0}, 500)
    state = states(hw)["wrist_3_joint"]
    assert state.get_velocity() == pytest.approx(2.0, abs=1e-3)
    hw.do_switch([], info)
    drive(hw, "velocity", {}, 200)
    stopped = state.get_position()
    drive(hw, "velocity", {}, 300)
    assert state.get_position() == pytest.approx(stopped, abs=1e-4)
    assert abs(state.get_velocity()) < 1e-4


def test_position_command_is_reached():
    hw = make()
    claim(hw, "position", "elbow_joint", "wrist_1_joint")
    drive(hw, "position", {"elbow_joint": 0.8, "wrist_1_joint": -0.5}, 2000)
    assert states(hw)["elbow_joint"].get_position() == pytest.approx(0.8, abs=1e-4)
    assert states(hw)["wrist_1_joint"].get_position() == pytest.approx(-0.5, abs=1e-4)


def test_effort_command_is_the_effort_of_the_motor():
    hw = make(WRIST)
    claim(hw, "effort", "wrist_pitch_joint", "wrist_roll_joint")
    drive(hw, "effort", {"wrist_pitch_joint": 0.3, "wrist_roll_joint": -0.2}, 10)
    assert states(hw)["wrist_pitch_joint"].get_effort() == pytest.approx(0.3)
    assert states(hw)["wrist_roll_joint"].get_effort() == pytest.approx(-0.2)


def test_joint_with_gains_is_driven_by_its_pid():
    # Unit inertia would be hidden behind links; the last joint's is its armature alone.
    gains = {"wrist_3_joint": {"p": 40.0, "d": 4.0}}
    hw = make(pid_gains=gains, armature=0.1)
    claim(hw, "position", "wrist_3_joint")
    state = states(hw)["wrist_3_joint"]
    drive(hw, "position", {"wrist_3_joint": 0.001}, 1)
    hw.read(0.0, PERIOD)
    # p e + d e/T of the first cycle, e = 0.001
    assert state.get_effort() == pytest.approx(40.0 * 0.001 + 4.0)
    drive(hw, "position", {"wrist_3_joint": 0.001}, 1500)
    assert state.get_position() == pytest.approx(0.001, abs=1e-5)


def test_differential_motors_move_with_both_joints():
    hw = make(WRIST)
    joints = {"wrist_pitch_joint": 0.4, "wrist_roll_joint": -0.7}
    claim(hw, "position", *joints)
    drive(hw, "position", joints, 1500)
    motors = {
        h.name: h.get_position() for h in hw.get(ActuatorStateInterface).handles()
    }
    # Offsets 0.1 and -0.2, joint reductions 2 and 1, actuator reductions 50 and -50.
    pitch, roll = 0.4 - 0.1, -0.7 + 0.2
    assert motors["left_motor"] == pytest.approx(50.0 * (2.0 * pitch + roll), abs=0.01)
    assert motors["right_motor"] == pytest.approx(
        -50.0 * (2.0 * pitch - roll), abs=0.01
    )


@pytest.mark.parametrize("quantity", ["position", "effort"])
def test_four_bar_robot_follows_joint_commands(quantity: str):
    gains = {
        "hip_joint": {"p": 900.0, "d": 60.0},
        "knee_joint": {"p": 500.0, "d": 30.0},
    }
    # A PID inside makes motor efforts, a servo makes motor positions.
    hw = make(LEG, pid_gains=gains if quantity == "effort" else {})
    joints = {"hip_joint": 0.5, "knee_joint": 1.6}
    claim(hw, "position", *joints)
    drive(hw, "position", joints, 2500)
    for name, wanted in joints.items():
        assert states(hw)[name].get_position() == pytest.approx(wanted, abs=1e-3)
    knee = next(
        h for h in hw.get(ActuatorStateInterface).handles() if h.name == "knee_motor"
    )
    expected = 40.0 * (0.5 + 1.5 * (1.6 - 0.6))
    assert knee.get_position() == pytest.approx(expected, abs=0.2)


@pytest.mark.parametrize("direction", [1.0, -1.0])
@pytest.mark.parametrize("quantity", list(INTERFACES))
@pytest.mark.parametrize("reference", [UR5, PANDA])
def test_far_command_leaves_neither_range_nor_velocity_bound(
    reference: str, quantity: str, direction: float
):
    is_ur5 = reference == UR5
    start = {} if is_ur5 else {"panda_joint4": -1.5, "panda_joint6": 1.5}
    limits = UR5_SOFT_LIMITS if is_ur5 else {}
    hw = make(reference, initial_positions=start, joint_limits=limits)
    name = "shoulder_pan_joint" if is_ur5 else "panda_joint4"
    limit = load_urdf(load_robot_files(reference)).joints[name].limit
    claim(hw, quantity, name)
    state, outside, fastest = states(hw)[name], -inf, 0.0
    for far in (1e4 * direction, -1e4 * direction):
        for _ in range(2400):
            drive(hw, quantity, {name: far}, 1)
            position = state.get_position()
            outside = max(outside, limit.lower - position, position - limit.upper)
            fastest = max(fastest, abs(state.get_velocity()))
    assert degrees(outside) < 0.5
    assert limit.velocity * 0.9 < fastest < limit.velocity * 1.02


def test_a_limit_without_effect_is_refused_or_of_others_told(caplog):
    limits = {"elbow_joint": {"has_velocity_limit": True, "max_velocity": 1.0}}
    with pytest.raises(ParameterError, match=r"robot/joint_limits/elbow_joint/has_v"):
        make(UR5, joint_limits=limits)

    params = Parameters(ParameterTree({"joint_limits": limits}))
    robot = params.namespace("robot")
    robot.set("", {"robot_description": UR5})
    MujocoRobotHW().init(params, robot)
    assert "joint_limits/elbow_joint/has_velocity_limit is unknown" in caplog.text
    assert "max_velocity counts only with 'has_velocity_limits: true'" in caplog.text


@pytest.mark.parametrize("limit_mode", ["ros_control", "rate"])
def test_command_that_is_no_number_lets_the_joint_be_held(limit_mode: str):
    hw = make(limit_mode=limit_mode)
    claim(hw, "position", "wrist_3_joint", "elbow_joint")
    drive(hw, "position", {"wrist_3_joint": 0.2, "elbow_joint": 0.1}, 500)
    drive(hw, "position", {"wrist_3_joint": nan, "elbow_joint": 0.1}, 1)
    drive(hw, "position", {"wrist_3_joint": 1.0, "elbow_joint": 0.3}, 1000)
    assert states(hw)["wrist_3_joint"].get_position() == pytest.approx(0.2, abs=1e-3)
    assert states(hw)["elbow_joint"].get_position() == pytest.approx(0.3, abs=1e-3)


@pytest.mark.parametrize("quantity", list(INTERFACES))
@pytest.mark.parametrize("reference", [WRIST, LEG])
def test_bidirectional_transmissions_map_both_ways(
    reference: str, quantity: str, tmp_path: Path
):
    named = f"BiDirectional{quantity.title()}JointInterface"
    urdf = tmp_path / "robot.urdf"
    text = Path(reference).read_text(encoding="utf-8")
    urdf.write_text(text.replace("EffortJointInterface", named), encoding="utf-8")
    hw = make(str(urdf))
    joints = hw.get(INTERFACES[quantity]).get_names()
    claim(hw, quantity, *joints)
    # Near the start: neither limits nor range change the command.
    start = {name: state.get_position() for name, state in states(hw).items()}
    at = start if quantity == "position" else dict.fromkeys(joints, 0.0)
    wanted = {name: at[name] + 0.0005 for name in joints}
    drive(hw, quantity, wanted, 100)
    hw.read(0.0, PERIOD)
    actuators = list(hw.get(ActuatorStateInterface).handles())
    before = [(a.get_position(), a.get_velocity(), a.get_effort()) for a in actuators]
    hw.transmission_maps.get(JointToActuatorStateInterface).propagate()
    after = [(a.get_position(), a.get_velocity(), a.get_effort()) for a in actuators]
    # Rounding of one trip through the gears.
    assert after == [pytest.approx(state, rel=1e-9, abs=1e-12) for state in before]
    commands = hw.get(INTERFACES[quantity])
    for name in joints:
        commands.get_handle(name).set_command(0.0)
    hw.transmission_maps.get(FROM_ACTUATORS[quantity]).propagate()
    found = {name: commands.get_handle(name).get_command() for name in joints}
    assert found == pytest.approx(wanted, rel=1e-9)


def test_mimic_joint_has_a_state_and_no_command():
    hw = make(PANDA, initial_positions={"panda_joint4": -2.0, "panda_joint6": 2.0})
    claim(hw, "position", "panda_finger_joint1")
    drive(hw, "position", {"panda_finger_joint1": 0.03}, 1500)
    found = states(hw)["panda_finger_joint2"].get_position()
    assert found == pytest.approx(0.03, abs=5e-4)
    assert "panda_finger_joint2" not in hw.get(EffortJointInterface).get_names()


def test_period_sets_how_many_steps_the_world_makes():
    hw = make()
    hw.read(0.0, 0.003)
    assert hw.world.step_count == 3
    hw.write(0.0, 0.003)
    hw.read(0.0, 0.0)
    assert hw.world.step_count == 3
    hw.read(0.0, 0.1)
    assert hw.world.step_count == 23
    assert hw.lost_steps == 80


def test_loop_faster_than_the_simulation_is_refused():
    hw = make(timestep=0.002)
    with pytest.raises(HardwareInterfaceError, match="only 500 steps") as info:
        hw.check_period(0.001)
    assert "robot.timestep to 0.001" in info.value.remedy
    hw.check_period(0.002)


def test_loop_with_uneven_steps_is_reported(caplog: pytest.LogCaptureFixture):
    hw = make()
    hw.check_period(0.004)
    assert not caplog.records
    hw.check_period(0.0025)
    assert "a timestep of 0.000833333 s would fit" in caplog.text


def test_slow_loop_loses_no_steps():
    hw = make()
    hw.check_period(0.1)
    hw.read(0.0, 0.1)
    assert (hw.world.step_count, hw.lost_steps) == (100, 0)


def test_reset_keeps_a_running_controller():
    hw = make()
    claim(hw, "velocity", "wrist_3_joint")
    drive(hw, "velocity", {"wrist_3_joint": 1.0}, 300)
    hw.simulated_world().reset({"elbow_joint": 0.5})
    assert states(hw)["wrist_3_joint"].get_position() == 0.0
    assert states(hw)["elbow_joint"].get_position() == 0.5
    drive(hw, "velocity", {"wrist_3_joint": 1.0}, 300)
    assert states(hw)["wrist_3_joint"].get_velocity() == pytest.approx(1.0, abs=1e-3)


def test_things_stand_around_the_robot():
    ball = {"name": "ball", "type": "sphere", "size": [0.1], "position": [2, 0, 1]}
    tree = ParameterTree({
        "robot": {"robot_description": WRIST},
        "scene": {"objects": [ball]},
    })
    hw = MujocoRobotHW()
    hw.init(Parameters(tree), Parameters(tree, "robot"))
    (found,) = hw.simulated_world().scene()
    assert (found.name, found.position, found.mass) == ("ball", (2.0, 0.0, 1.0), 0.0)


def test_diverged_world_refuses_controllers():
    hw = make()
    hw.world.data.qvel[0] = 1e9
    hw.read(0.0, PERIOD)
    assert hw.mode() == "diverged"
    with pytest.raises(SwitchRefusedError, match="diverged"):
        claim(hw, "effort", "elbow_joint")
    hw.simulated_world().reset({})
    assert hw.mode() == "running"


def test_description_is_stored_for_controllers_and_screens():
    tree = ParameterTree({"robot": {"robot_description": WRIST}})
    MujocoRobotHW().init(Parameters(tree), Parameters(tree, "robot"))
    assert tree.get("robot_description") == Path(WRIST).read_text(encoding="utf-8")


@pytest.mark.parametrize("robot", ["kinova", "talos_left_arm"])
def test_other_robots_stand_still(robot: str):
    hw = make(f"example-robot-data:{robot}")
    before = {name: state.get_position() for name, state in states(hw).items()}
    drive(hw, "effort", {}, 500)
    for name, state in states(hw).items():
        assert state.get_position() == pytest.approx(before[name], abs=1e-4)
