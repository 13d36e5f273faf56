"""FrankaHW with its whole state, its errors and its world."""

import cProfile
import pstats
import re
from pathlib import Path

import pytest

from station.core.description.robot_files import load_robot_files
from station.core.franka import (
    FrankaModelInterface,
    FrankaPoseCartesianInterface,
    FrankaStateInterface,
    FrankaVelocityCartesianInterface,
)
from station.core.hardware.interfaces import (
    EffortJointInterface,
    PositionJointInterface,
)
from station.core.hardware.robot_hw import ControllerInfo, InterfaceResources
from station.core.parameters import Parameters, ParameterTree
from station.hw.franka.arm.arm_limits import FR3_LIMITS
from station.hw.franka.franka_hw import FrankaHW
from station.hw.franka.franka_parameters import INITIAL_POSITIONS
from tests.hw.franka.test_franka_hw import (
    PERIOD,
    ROBOT,
    command,
    controllers,
    drive,
    make,
    measured,
    run,
    switch,
)

FR3_JOINTS = [f"fr3_joint{number}" for number in range(1, 8)]


@pytest.fixture
def hw() -> FrankaHW:
    return make()


@pytest.fixture(scope="module")
def without_soft_limits(tmp_path_factory: pytest.TempPathFactory) -> str:
    """Return the path of the Panda's URDF without its safety controllers."""
    description = load_robot_files("example-robot-data:panda")
    xml = re.sub(r"<safety_controller [^>]*/>", "", description.xml)
    path = tmp_path_factory.mktemp("urdf") / "panda.urdf"
    path.write_text(xml)
    return str(path)


def test_all_eight_interfaces_have_upstreams_names(hw: FrankaHW) -> None:
    assert hw.get(FrankaStateInterface).get_names() == ["panda_robot"]
    assert hw.get(FrankaPoseCartesianInterface).get_names() == ["panda_robot"]
    assert hw.get(FrankaVelocityCartesianInterface).get_names() == ["panda_robot"]
    models = hw.get(FrankaModelInterface)
    assert models.get_names() == ["panda_model", "panda_robot"]
    mass = models.get_handle("panda_robot").get_mass()
    assert mass == models.get_handle("panda_model").get_mass()
    assert {
        "franka_hw::FrankaStateInterface",
        "franka_hw::FrankaModelInterface",
        "franka_hw::FrankaPoseCartesianInterface",
        "franka_hw::FrankaVelocityCartesianInterface",
    } <= set(hw.get_names())


@pytest.mark.parametrize("cutoff", [100.0, 1000.0])
def test_torque_step_is_no_error_with_the_limiter_on(cutoff: float) -> None:
    hw = make(cutoff_frequency=cutoff)
    switch(hw, "jt")
    drive(hw, EffortJointInterface, [0.0] * 7, 10)
    drive(hw, EffortJointInterface, [2.0] + [0.0] * 6, 20)
    assert hw.robot_state.tau_J_d[0] == pytest.approx(2.0, abs=0.02)
    assert not any(hw.robot_state.current_errors)
    assert hw.mode() == "move"


def test_torque_step_is_an_error_with_the_limiter_off() -> None:
    hw = make(rate_limiting=False, cutoff_frequency=1000.0)
    switch(hw, "jt")
    drive(hw, EffortJointInterface, [0.0] * 7, 10)
    drive(hw, EffortJointInterface, [2.0] + [0.0] * 6, 2)
    assert hw.mode() == "reflex"
    (error,) = hw.arm.errors()
    assert error.name == "controller_torque_discontinuity"
    assert (error.where, error.value, error.limit) == ("joint1", 2000.0, 1000.0)
    assert hw.is_interrupted()
    (info,) = controllers("jt")
    assert "went to reflex (controller_torque_discontinuity" in hw.interruption_of(info)


def called_modules(hw: FrankaHW, cycles: int) -> set[str]:
    """Return the modules whose functions ran in some cycles."""
    profile = cProfile.Profile()
    profile.runcall(run, hw, cycles)
    return {Path(file).stem for file, _, _ in pstats.Stats(profile).stats}


KINEMATICS = {"franka_kinematics"}
DYNAMICS = {"franka_dynamics", "franka_model"}


@pytest.mark.parametrize("kind", ["none", "jt", "jp", "jv", "jt+jp"])
def test_nobody_pays_for_kinematics_or_dynamics_that_nobody_asks_for(
    hw: FrankaHW, kind: str
) -> None:
    switch(hw, kind)
    run(hw, 300)
    before = hw.robot_state.time
    called = called_modules(hw, 200)
    assert hw.robot_state.time == pytest.approx(before + 0.2)
    assert not called & (KINEMATICS | DYNAMICS)


def test_derived_state_is_computed_once_per_cycle(hw: FrankaHW) -> None:
    handle = hw.get(FrankaStateInterface).get_handle("panda_robot")
    run(hw, 1)
    pose = handle.get_robot_state().doubles("O_T_EE")
    pose[12] = 9.0
    for _ in range(5):
        handle.get_robot_state()

    assert pose[12] == 9.0
    run(hw, 1)
    handle.get_robot_state()
    assert pose[12] < 1.0


VELOCITY = "joint_motion_generator_velocity_limits_violation"
ACCELERATION = "joint_motion_generator_velocity_discontinuity"
JERK = "joint_motion_generator_acceleration_discontinuity"


@pytest.mark.parametrize(
    ("jump", "names"),
    [
        (3e-6, []),
        (1e-5, [JERK]),
        (1e-4, [ACCELERATION, JERK]),
        (5e-3, [VELOCITY, ACCELERATION, JERK]),
    ],
)
def test_position_jump_raises_the_errors_of_the_limits_it_exceeds(
    jump: float, names: list[str], without_soft_limits: str
) -> None:
    hw = make(
        robot_description=without_soft_limits,
        rate_limiting=False,
        cutoff_frequency=1000.0,
    )
    switch(hw, "jp")
    rest = list(hw.robot_state.q_d)
    drive(hw, PositionJointInterface, rest, 10)
    drive(hw, PositionJointInterface, [rest[0] + jump, *rest[1:]], 10)
    assert [error.name for error in hw.arm.errors()] == names
    assert hw.mode() == ("reflex" if names else "move")


def test_soft_limits_take_the_velocity_out_of_a_position_jump() -> None:
    hw = make(rate_limiting=False, cutoff_frequency=1000.0)
    switch(hw, "jp")
    rest = list(hw.robot_state.q_d)
    drive(hw, PositionJointInterface, rest, 10)
    drive(hw, PositionJointInterface, [rest[0] + 0.5, *rest[1:]], 2)
    # They let a command change by the largest velocity, as franka_hw has it.
    assert [error.name for error in hw.arm.errors()] == [ACCELERATION, JERK]


def test_position_jump_is_no_error_with_the_limiter_on(hw: FrankaHW) -> None:
    switch(hw, "jp")
    rest = list(hw.robot_state.q_d)
    drive(hw, PositionJointInterface, [rest[0] + 0.5, *rest[1:]], 100)
    assert hw.mode() == "move"


@pytest.mark.slow
def test_zero_torque_lets_the_arm_drift_by_less_than_five_mrad(hw: FrankaHW) -> None:
    switch(hw, "jt")
    for _ in range(60_000):
        hw.read(0.0, PERIOD)
        hw.write(0.0, PERIOD)
    assert measured(hw) == pytest.approx(INITIAL_POSITIONS, abs=5e-3)


@pytest.mark.parametrize("rate", [0.002, 0.005, 0.01])
def test_slower_loops_follow_positions_without_an_error(rate: float) -> None:
    hw = make()
    hw.check_period(rate)
    switch(hw, "jp")
    goal = [q + 0.1 for q in INITIAL_POSITIONS]
    for _ in range(round(4.0 / rate)):
        command(hw, PositionJointInterface, goal)
        run(hw, 1, rate)
    assert hw.mode() == "move", hw.arm.errors()
    assert measured(hw) == pytest.approx(goal, abs=2e-3)


def test_fr3_is_an_arm_with_names_and_limits_of_its_own() -> None:
    hw = make(arm_id="fr3")
    assert hw.arm.limits is FR3_LIMITS
    assert hw.get(FrankaStateInterface).get_names() == ["fr3_robot"]
    reports = {report.joint: report for report in hw.joint_limits()}
    assert list(reports) == FR3_JOINTS
    elbow = reports["fr3_joint4"].limits
    assert (elbow.min_position, elbow.max_position) == (-2.7478, -0.4461)
    assert (elbow.max_velocity, elbow.max_acceleration) == (1.25, 9.999)
    # The world stops the joints where the arm does, not where its URDF advises.
    stops = hw.simulated_world().world.joints(FR3_JOINTS)
    widest = zip(stops.upper_limits, FR3_LIMITS.upper, strict=True)
    assert all(0.0 <= stop - limit < 0.1 for stop, limit in widest)


@pytest.mark.parametrize("key", ["arm", "arm_type"])
def test_arm_fr3_with_the_names_of_a_panda_is_an_fr3_and_told(
    key: str, caplog: pytest.LogCaptureFixture
) -> None:
    hw = make(**{key: "fr3"})
    assert hw.arm.limits is FR3_LIMITS
    assert hw.joint_limits()[0].joint == "panda_joint1"
    assert hw.joint_limits()[0].limits.max_position == 2.3093
    assert "arm chooses a model fr3" in caplog.text


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_fr3_follows_positions_within_its_limits(sign: float) -> None:
    hw = make(arm_id="fr3")
    claim = InterfaceResources(PositionJointInterface.type_name, tuple(FR3_JOINTS))
    hw.do_switch([ControllerInfo("jp", "test/Controller", (claim,))], [])
    handles = [hw.get(PositionJointInterface).get_handle(name) for name in FR3_JOINTS]
    goal = [q + 0.3 * sign for q in INITIAL_POSITIONS]
    goal[0] = 9.0 * sign
    fastest = 0.0
    for _ in range(3_000):
        for handle, value in zip(handles, goal, strict=True):
            handle.set_command(value)
        run(hw, 1)
        fastest = max(fastest, abs(hw.robot_state.dq_d[0]))
    assert hw.arm.errors() == []
    expected = [2.3093 * sign, *goal[1:]]
    assert hw.robot_state.q_d == pytest.approx(expected, abs=1e-3)
    assert 1.9 < fastest < 2.62


def test_gravity_vector_is_carried_as_well() -> None:
    hw = make(gravity=[3.0, 0.0, -8.0])
    run(hw, 500)
    assert measured(hw) == pytest.approx(INITIAL_POSITIONS, abs=1e-6)
    assert hw.robot_state.O_ddP_O == [3.0, 0.0, -8.0]


def test_things_of_the_scene_are_in_the_world() -> None:
    tree = ParameterTree({
        "robot": ROBOT,
        "scene": {
            "objects": [
                {
                    "name": "box",
                    "type": "box",
                    "size": [0.1, 0.1, 0.1],
                    "position": [0.6, 0.3, 0.05],
                    "mass": 1.0,
                }
            ]
        },
    })
    hw = FrankaHW()
    hw.init(Parameters(tree), Parameters(tree, "robot"))
    run(hw, 100)
    assert measured(hw) == pytest.approx(INITIAL_POSITIONS, abs=1e-6)
    assert hw.simulated_world().world.data.body("box").xpos[2] == pytest.approx(
        0.05, abs=2e-3
    )
