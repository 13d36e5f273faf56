"""FrankaHW with its whole state, its errors and its world."""

import pytest

from station.core.interfaces import (
    EffortJointInterface,
    FrankaModelInterface,
    FrankaPoseCartesianInterface,
    FrankaStateInterface,
    FrankaVelocityCartesianInterface,
    PositionJointInterface,
)
from station.core.parameters import Parameters, ParameterTree
from station.hw.franka.franka_hw import FrankaHW
from station.hw.franka.simulation import INITIAL_POSITIONS
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


@pytest.fixture
def hw() -> FrankaHW:
    return make()


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


def test_torque_step_is_no_error_with_the_limiter_on(hw: FrankaHW) -> None:
    switch(hw, "jt")
    for _ in range(10):
        drive(hw, EffortJointInterface, [2.0] + [0.0] * 6, 1)
    assert hw.mode() == "move"


def test_torque_step_is_an_error_with_the_limiter_off() -> None:
    hw = make(rate_limiting=False, cutoff_frequency=1000.0)
    switch(hw, "jt")
    drive(hw, EffortJointInterface, [0.0] * 7, 10)
    drive(hw, EffortJointInterface, [2.0] + [0.0] * 6, 2)
    assert hw.mode() == "reflex"
    assert hw.arm.errors()[0].name == "controller_torque_discontinuity"
    assert hw.is_interrupted()
    (info,) = controllers("jt")
    assert "went to reflex (controller_torque_discontinuity" in hw.interruption_of(info)


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


def test_fr3_has_limits_of_its_own() -> None:
    hw = make(arm_type="fr3")
    assert hw.arm.limits.velocity[4] == 5.26


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
    assert hw.simulation.world.data.body("box").xpos[2] == pytest.approx(0.05, abs=2e-3)
