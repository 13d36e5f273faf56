"""FrankaHW between controllers and the simulated arm."""

from itertools import product
from math import degrees

import pytest

from station.core.errors import (
    HardwareInterfaceError,
    ParameterError,
    SwitchRefusedError,
)
from station.core.hardware.interfaces import (
    EffortJointInterface,
    JointStateInterface,
    PositionJointInterface,
    VelocityJointInterface,
)
from station.core.hardware.robot_hw import (
    ControllerInfo,
    InterfaceResources,
    SwitchState,
)
from station.core.parameters import Parameters, ParameterTree
from station.hw.franka.arm.control_mode import ControlMode
from station.hw.franka.franka_hw import FrankaHW
from station.hw.franka.franka_parameters import INITIAL_POSITIONS
from station.memory.doubles import put

PERIOD = 0.001
ROBOT = {"arm_id": "panda", "robot_description": "example-robot-data:panda"}
JOINTS = tuple(f"panda_joint{number}" for number in range(1, 8))
INTERFACES = {
    "jt": (EffortJointInterface,),
    "jp": (PositionJointInterface,),
    "jv": (VelocityJointInterface,),
    "jt+jp": (EffortJointInterface, PositionJointInterface),
    "jt+jv": (EffortJointInterface, VelocityJointInterface),
}
MODES = ["none", *INTERFACES]


def make(**parameters: object) -> FrankaHW:
    tree = ParameterTree({"robot": {**ROBOT, "realism": "ideal", **parameters}})
    hw = FrankaHW()
    hw.init(Parameters(tree), Parameters(tree, "robot"))
    return hw


@pytest.fixture
def hw() -> FrankaHW:
    return make()


def controllers(kind: str) -> list[ControllerInfo]:
    if kind == "none":
        return []
    claims = tuple(
        InterfaceResources(interface.type_name, JOINTS)
        for interface in INTERFACES[kind]
    )
    return [ControllerInfo(kind, "test/Controller", claims)]


def switch(hw: FrankaHW, start: str, stop: str = "none") -> None:
    hw.prepare_switch(controllers(start), controllers(stop))
    hw.do_switch(controllers(start), controllers(stop))


def run(hw: FrankaHW, cycles: int, period: float = PERIOD) -> None:
    for _ in range(cycles):
        hw.read(0.0, period)
        hw.write(0.0, period)


def command(hw: FrankaHW, interface: type, values: list[float]) -> None:
    provided = hw.get(interface)
    for name, value in zip(JOINTS, values, strict=True):
        provided.get_handle(name).set_command(value)


def drive(hw: FrankaHW, interface: type, values: list[float], cycles: int) -> None:
    """Command anew each cycle, as a controller does: limits change the buffers."""
    for _ in range(cycles):
        command(hw, interface, values)
        run(hw, 1)


def measured(hw: FrankaHW) -> list[float]:
    handles = hw.get(JointStateInterface).handles()
    return [handle.get_position() for handle in handles]


def test_interfaces_have_the_names_of_the_joints(hw: FrankaHW) -> None:
    for interface in (
        JointStateInterface,
        PositionJointInterface,
        VelocityJointInterface,
        EffortJointInterface,
    ):
        names = hw.get(interface).get_names()
        assert tuple(name for name in names if "finger" not in name) == JOINTS
        assert hw.get(interface).get_claims() == []


def test_state_is_measured_for_torques_and_desired_for_motions(hw: FrankaHW) -> None:
    switch(hw, "jv")
    drive(hw, VelocityJointInterface, [0.1] * 7, 50)
    state = hw.robot_state
    assert state.q != state.q_d
    for interface, q, dq in (
        (JointStateInterface, state.q, state.dq),
        (EffortJointInterface, state.q, state.dq),
        (PositionJointInterface, state.q_d, state.dq_d),
        (VelocityJointInterface, state.q_d, state.dq_d),
    ):
        handles = [h for h in hw.get(interface).handles() if h.name in JOINTS]
        assert [handle.get_position() for handle in handles] == q
        assert [handle.get_velocity() for handle in handles] == dq
        assert [handle.get_effort() for handle in handles] == state.tau_J


def test_arm_without_controllers_holds_its_start_pose(hw: FrankaHW) -> None:
    run(hw, 1_000)
    assert measured(hw) == pytest.approx(INITIAL_POSITIONS, abs=1e-6)
    assert hw.mode() == "idle"


@pytest.mark.parametrize(("first", "second"), list(product(MODES, MODES)))
def test_switch_does_not_move_the_arm(hw: FrankaHW, first: str, second: str) -> None:
    switch(hw, first)
    run(hw, 100)
    before = measured(hw)
    switch(hw, second, first)
    for _ in range(100):
        run(hw, 1)
        assert measured(hw) == pytest.approx(before, abs=1e-3)
    assert hw.mode() == ("idle" if second == "none" else "move")


def test_failed_controller_is_taken_off_without_preparation(hw: FrankaHW) -> None:
    switch(hw, "jt")
    drive(hw, EffortJointInterface, [10.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], 100)
    hw.do_switch([], controllers("jt"))
    run(hw, 500)
    assert hw.control_mode is ControlMode.NONE
    held = measured(hw)
    run(hw, 200)
    assert measured(hw) == pytest.approx(held, abs=1e-4)


def test_switch_of_a_reading_controller_does_not_interrupt(hw: FrankaHW) -> None:
    switch(hw, "jv")
    drive(hw, VelocityJointInterface, [0.2] * 7, 100)
    publisher = ControllerInfo(
        "p", "t/P", (InterfaceResources(JointStateInterface.type_name, ()),)
    )
    hw.prepare_switch([publisher], [])
    hw.do_switch([publisher], [])
    drive(hw, VelocityJointInterface, [0.2] * 7, 1)
    assert hw.robot_state.dq_d == pytest.approx([0.2] * 7, abs=1e-3)


def test_position_step_is_reached_without_overshoot(hw: FrankaHW) -> None:
    switch(hw, "jp")
    goal = [q + 0.3 for q in INITIAL_POSITIONS]
    highest = list(INITIAL_POSITIONS)
    for _ in range(1_500):
        drive(hw, PositionJointInterface, goal, 1)
        highest = list(map(max, highest, measured(hw)))
    assert measured(hw) == pytest.approx(goal, abs=1e-4)
    # The following error while braking with 10 rad/s^2 at 3000 Nm/rad.
    assert highest == pytest.approx(goal, abs=0.01)


@pytest.mark.parametrize(
    ("kind", "interface", "value"),
    [
        ("jp", PositionJointInterface, 100.0),
        ("jp", PositionJointInterface, -100.0),
        ("jv", VelocityJointInterface, 100.0),
        ("jv", VelocityJointInterface, -100.0),
    ],
)
def test_commands_far_outside_are_kept_within_the_limits(
    hw: FrankaHW, kind: str, interface: type, value: float
) -> None:
    switch(hw, kind)
    state = hw.robot_state
    rest = state.q_d[1:] if kind == "jp" else [0.0] * 6
    farthest = fastest = 0.0
    for _ in range(2_000):
        drive(hw, interface, [value, *rest], 1)
        farthest = max(farthest, abs(state.q[0]))
        fastest = max(fastest, abs(state.dq[0]))
    assert abs(state.q[0]) == pytest.approx(2.8973, abs=2e-3)
    # Full speed up to the limit: the arm springs beyond it, as its stiffness lets it.
    assert degrees(farthest - 2.8973) < 1.0
    assert fastest < 2.175 * 1.02
    assert sum(clamp.count for clamp in hw.clamps()) > 0


def test_torques_are_limited_and_filtered(hw: FrankaHW) -> None:
    switch(hw, "jt")
    command(hw, EffortJointInterface, [500.0] + [0.0] * 6)
    run(hw, 2)
    # 1000 Nm/s less the margin; the first command acts in the second cycle.
    assert hw.robot_state.tau_J_d[0] == pytest.approx(1.0, abs=1e-3)


def test_filter_can_be_switched_off(hw: FrankaHW) -> None:
    hw = make(rate_limiting=False, cutoff_frequency=1000.0)
    switch(hw, "jt")
    command(hw, EffortJointInterface, [0.9] + [0.0] * 6)
    run(hw, 2)
    assert hw.robot_state.tau_J_d[0] == 0.9


def test_filter_settings_are_read_again_before_a_switch() -> None:
    tree = ParameterTree({"robot": ROBOT})
    hw = FrankaHW()
    hw.init(Parameters(tree), Parameters(tree, "robot"))
    tree.set("robot", {**ROBOT, "rate_limiting": False})
    tree.set("robot/cutoff_frequency", 1000.0)
    switch(hw, "jt")
    command(hw, EffortJointInterface, [0.9] + [0.0] * 6)
    run(hw, 2)
    assert hw.robot_state.tau_J_d[0] == 0.9


def test_wrong_setting_refuses_the_switch_and_changes_nothing() -> None:
    tree = ParameterTree({"robot": ROBOT})
    hw = FrankaHW()
    hw.init(Parameters(tree), Parameters(tree, "robot"))
    tree.set("robot/cutoff_frequency", -1.0)
    with pytest.raises(SwitchRefusedError, match=r"cutoff_frequency' is -1\.0"):
        switch(hw, "jt")
    assert hw.mode() == "idle"


@pytest.mark.parametrize(("running", "start"), [("jp", "jv"), ("jt+jp", "jv")])
def test_unsupported_mode_is_refused_by_name(
    hw: FrankaHW, running: str, start: str
) -> None:
    switch(hw, running)
    with pytest.raises(SwitchRefusedError, match="cannot be in mode joint_"):
        hw.prepare_switch(controllers(start), [])
    run(hw, 1)
    assert hw.mode() == "move"


def test_conflict_names_the_controller_that_claims_the_joints(hw: FrankaHW) -> None:
    running = [*controllers("jp"), *controllers("jv")]
    assert "claimed by 'jp'" in hw.check_for_conflict(running)[0].reason
    assert hw.check_for_conflict([*controllers("jp"), *controllers("jt")]) == []


@pytest.mark.parametrize(
    ("kind", "interface"),
    [
        ("jt", EffortJointInterface),
        ("jp", PositionJointInterface),
        ("jv", VelocityJointInterface),
    ],
)
def test_command_that_is_not_finite_stops_the_motion(
    hw: FrankaHW, kind: str, interface: type
) -> None:
    switch(hw, kind)
    run(hw, 10)
    command(hw, interface, [float("nan")] + [0.0] * 6)
    run(hw, 500)
    assert hw.mode() == "idle"
    assert measured(hw) == pytest.approx(INITIAL_POSITIONS, abs=1e-3)


def test_diverged_arm_refuses_to_start_until_reset(hw: FrankaHW) -> None:
    switch(hw, "jp")
    run(hw, 10)
    hw.simulated_world().world.data.qvel[0] = float("nan")
    run(hw, 10)
    assert hw.mode() == "other"
    hw.do_switch(controllers("jt"), controllers("jp"))
    assert hw.switch_result() is SwitchState.ERROR
    with pytest.raises(SwitchRefusedError, match="diverged"):
        switch(hw, "jp", "jt")
    hw.simulated_world().reset({})
    run(hw, 10)
    assert hw.mode() == "move"


def test_reset_puts_the_arm_at_a_pose_and_controllers_survive(hw: FrankaHW) -> None:
    switch(hw, "jp")
    run(hw, 50)
    hw.simulated_world().reset({"panda_joint1": 0.5})
    run(hw, 200)
    assert measured(hw) == pytest.approx([0.5, *INITIAL_POSITIONS[1:]], abs=1e-4)
    assert hw.mode() == "move"


@pytest.mark.parametrize(
    ("period", "cycles", "expected"),
    [
        (0.001, 100, 0.1),
        (0.002, 100, 0.2),
        (0.0005, 100, 0.05),
        (0.0, 10, 0.0),
        (1.0, 1, 0.021),  # the arm stops after 20 lost packets
    ],
)
def test_simulated_time_follows_the_elapsed_time(
    hw: FrankaHW, period: float, cycles: int, expected: float
) -> None:
    run(hw, cycles, period)
    assert hw.robot_state.time == pytest.approx(expected, abs=1e-9)


def test_urdf_is_published_with_the_names_of_this_arm() -> None:
    tree = ParameterTree({"robot": {**ROBOT, "arm_id": "left"}})
    hw = FrankaHW()
    hw.init(Parameters(tree), Parameters(tree, "robot"))
    assert 'name="left_joint1"' in tree.get("robot_description")
    assert hw.get(JointStateInterface).get_names()[0] == "left_joint1"


def test_warning_names_joints_close_to_their_limits() -> None:
    hw = make(initial_positions=[2.85, 0.0, 0.0, -1.5, 0.0, 1.5, 0.0])
    assert hw.joint_limit_warnings() == ["panda_joint1 is 2.7 degrees from a limit"]


def test_unknown_parameter_is_refused() -> None:
    with pytest.raises(ParameterError, match="robot/speed' is unknown to FrankaHW"):
        make(speed=1)


@pytest.mark.parametrize("arm_cycles", [1, 2, 4])
def test_a_slower_loop_moves_the_arm_alike(hw, arm_cycles):
    period, seconds = arm_cycles * PERIOD, 0.4
    switch(hw, "jp")
    hw.read(0.0, period)
    target = [q + 0.05 for q in hw.robot_state.q_d]
    for cycle in range(1, round(seconds / period) + 1):
        put(hw.commands.positions, target)
        hw.write(cycle * period, period)
        hw.read(cycle * period, period)
    assert hw.robot_state.q_d == pytest.approx(target, abs=1e-3)


def test_each_cycle_of_the_arm_gets_a_command_whatever_the_rate_of_the_loop(hw):
    hw.check_period(4 * PERIOD)
    switch(hw, "jt")
    step_until_torques_act(hw)
    put(hw.commands.efforts, [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 5.0])
    hw.write(1.0, 4 * PERIOD)
    hw.read(1.004, 4 * PERIOD)
    # The Panda's torques may change by 1 Nm per cycle; the low-pass takes a little off.
    assert 3.5 < hw.robot_state.tau_J_d[6] <= 4.0


def step_until_torques_act(hw: FrankaHW) -> None:
    for cycle in range(200):
        hw.write(cycle * PERIOD, PERIOD)
        hw.read(cycle * PERIOD, PERIOD)


def test_a_loop_faster_than_the_arm_is_refused_with_the_reason(hw):
    with pytest.raises(HardwareInterfaceError, match="at most 1000 commands"):
        hw.check_period(0.0005)


def test_a_loop_too_slow_for_usual_gains_is_warned_of(hw, caplog):
    hw.check_period(0.001)
    hw.check_period(0.004)
    assert not caplog.records
    hw.check_period(0.01)
    assert "small gains" in caplog.text
