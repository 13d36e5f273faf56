"""The contract of `RobotArm`, which every arm behind the seam must pass."""

from math import nan

import pytest

from station.core.errors import ArmCommandError, InvalidCommandError
from station.core.franka import ArmSimulation, CollisionBehavior, Frame, RobotMode
from station.core.franka.franka_errors import error_names
from station.hw.franka.arm.collision_behavior import DEFAULT_COLLISION_BEHAVIOR
from station.hw.franka.arm.franka_kinematics import IDENTITY
from station.hw.franka.arm.rigid_body import RigidBody
from station.hw.franka.arm.robot_arm import (
    MOST_LOST_PACKETS,
    ControllerMode,
    MotionGeneratorMode,
    RobotArm,
)

JOINT, EXTERNAL = ControllerMode.JOINT_IMPEDANCE, ControllerMode.EXTERNAL_CONTROLLER
CARTESIAN = ControllerMode.CARTESIAN_IMPEDANCE
NONE = MotionGeneratorMode.NONE
POSITION = MotionGeneratorMode.JOINT_POSITION
VELOCITY = MotionGeneratorMode.JOINT_VELOCITY
POSE = MotionGeneratorMode.CARTESIAN_POSITION
TWIST = MotionGeneratorMode.CARTESIAN_VELOCITY
MODES = [
    (EXTERNAL, NONE),
    *(
        (controller, generator)
        for controller in ControllerMode
        for generator in MotionGeneratorMode
        if generator is not NONE
    ),
]
LOST = "communication_constraints_violation"

# The method of each command, the number of its arguments, and the modes that accept it.
COMMANDS = {
    "command_joint_torques": (7, (EXTERNAL, NONE)),
    "command_joint_positions": (7, (JOINT, POSITION)),
    "command_joint_velocities": (7, (JOINT, VELOCITY)),
    "command_cartesian_pose": (16, (CARTESIAN, POSE)),
    "command_cartesian_velocity": (6, (CARTESIAN, TWIST)),
}
END_EFFECTOR_FRAME = [*IDENTITY[:14], 0.1, 1.0]
SETTERS = {
    "set_joint_impedance": [1000.0] * 7,
    "set_cartesian_impedance": [500.0] * 3 + [50.0] * 3,
    "set_end_effector_frame": END_EFFECTOR_FRAME,
    "set_stiffness_frame": [*IDENTITY[:14], 0.2, 1.0],
    "set_load": RigidBody(0.5, (0.0, 0.0, 0.1), (0.01, 0, 0, 0, 0.01, 0, 0, 0, 0.01)),
    "set_collision_behavior": DEFAULT_COLLISION_BEHAVIOR,
}


def hold(arm: RobotArm) -> None:
    """Command the present position and let one cycle pass."""
    arm.command_joint_positions(list(arm.state.q_d))
    arm.read_once()


def lose(arm: RobotArm, packets: int) -> None:
    """Begin a motion at rest, and omit commands of several cycles in a row."""
    arm.start_motion(JOINT, POSITION)
    hold(arm)
    for _ in range(packets):
        arm.read_once()


def mode_of(arm: RobotArm) -> RobotMode:
    """Return the mode of the arm."""
    return arm.state.robot_mode


class ArmConformance:
    """Tests that an arm keeps the contract of `RobotArm`.

    Derive a test class and override the fixture `arm`.
    """

    @pytest.fixture
    def arm(self) -> RobotArm:
        """Return an arm that is idle, at rest, and free to move.

        Raises:
            NotImplementedError: The test class does not override this fixture.
        """
        raise NotImplementedError("Override the fixture `arm`.")

    @pytest.fixture
    def resolution(self) -> float:
        """Return the resolution of the arm's state [m, rad, kg].

        Override it for an arm whose state has single precision.
        """
        return 1e-12

    def test_new_arm_is_idle_at_rest_and_free_to_move(self, arm: RobotArm) -> None:
        assert mode_of(arm) is RobotMode.IDLE
        assert arm.is_at_rest()
        assert arm.remedy() is None
        assert arm.errors() == []
        assert arm.log() == []

    def test_state_is_one_object_whose_time_grows_by_a_cycle_per_read(
        self, arm: RobotArm
    ) -> None:
        state, before = arm.state, arm.state.time
        q, commanded = state.doubles("q"), state.doubles("q_d")

        assert arm.read_once() is state
        assert arm.read_once() is state
        assert state.time == pytest.approx(before + 2 * arm.cycle_time)
        assert state.doubles("q") is q
        assert state.doubles("q_d") is commanded

    @pytest.mark.parametrize(("controller", "generator"), MODES)
    def test_motion_starts_from_idle_and_ends_in_idle(
        self, arm: RobotArm, controller: ControllerMode, generator: MotionGeneratorMode
    ) -> None:
        assert arm.refusal(controller, generator) is None

        arm.start_motion(controller, generator)
        assert mode_of(arm) is RobotMode.MOVE
        arm.stop_motion()
        assert mode_of(arm) is RobotMode.IDLE
        arm.stop_motion()
        assert mode_of(arm) is RobotMode.IDLE

    def test_second_motion_is_refused_and_the_first_goes_on(
        self, arm: RobotArm
    ) -> None:
        arm.start_motion(JOINT, POSITION)
        with pytest.raises(ArmCommandError, match="runs already"):
            arm.start_motion(JOINT, VELOCITY)

        hold(arm)
        assert mode_of(arm) is RobotMode.MOVE

    @pytest.mark.parametrize("controller", [JOINT, CARTESIAN])
    def test_internal_controller_needs_a_motion_generator(
        self, arm: RobotArm, controller: ControllerMode
    ) -> None:
        assert arm.refusal(controller, NONE) is not None
        with pytest.raises(ArmCommandError, match="needs a motion generator"):
            arm.start_motion(controller, NONE)
        assert mode_of(arm) is RobotMode.IDLE

    @pytest.mark.parametrize("command", COMMANDS)
    def test_command_is_refused_without_its_motion(
        self, arm: RobotArm, command: str
    ) -> None:
        size, modes = COMMANDS[command]
        with pytest.raises(ArmCommandError):
            getattr(arm, command)([0.0] * size)

        other = (JOINT, VELOCITY) if modes != (JOINT, VELOCITY) else (JOINT, POSITION)
        arm.start_motion(*other)
        with pytest.raises(ArmCommandError):
            getattr(arm, command)([0.0] * size)

    @pytest.mark.parametrize("command", COMMANDS)
    @pytest.mark.parametrize("wrong", ["short", "long", "nan"])
    def test_command_of_a_wrong_size_or_not_finite_is_refused(
        self, arm: RobotArm, command: str, wrong: str
    ) -> None:
        size, modes = COMMANDS[command]
        arm.start_motion(*modes)
        numbers = {
            "short": [0.0] * (size - 1),
            "long": [0.0] * (size + 1),
            "nan": [nan] * size,
        }[wrong]

        with pytest.raises(InvalidCommandError):
            getattr(arm, command)(numbers)
        arm.read_once()
        assert mode_of(arm) is RobotMode.MOVE
        assert arm.is_at_rest()

    @pytest.mark.parametrize("elbow", [[0.0], [0.0, 0.5], [0.0, 0.0]])
    def test_impossible_elbow_is_refused(
        self, arm: RobotArm, elbow: list[float]
    ) -> None:
        arm.start_motion(CARTESIAN, TWIST)
        with pytest.raises(InvalidCommandError, match=r"[Ee]lbow"):
            arm.command_cartesian_velocity([0.0] * 6, elbow)

    def test_arm_stays_where_it_is_until_the_first_command(self, arm: RobotArm) -> None:
        before = list(arm.state.q_d)
        arm.start_motion(JOINT, POSITION)
        for _ in range(2 * MOST_LOST_PACKETS):
            arm.read_once()

        assert mode_of(arm) is RobotMode.MOVE
        assert arm.state.q_d == pytest.approx(before)
        assert arm.is_at_rest()

    def test_command_shows_in_the_state_of_the_next_cycle(
        self, arm: RobotArm, resolution: float
    ) -> None:
        arm.start_motion(JOINT, POSITION)
        target = [q + 1e-6 for q in arm.state.q_d]
        arm.command_joint_positions(target)
        assert list(arm.state.q_d) != target
        arm.read_once()
        assert arm.state.q_d == pytest.approx(target, abs=resolution)

    def test_caller_may_change_its_list_after_a_command(self, arm: RobotArm) -> None:
        arm.start_motion(JOINT, POSITION)
        command = list(arm.state.q_d)
        target = list(command)
        arm.command_joint_positions(command)
        command[0] += 1.0
        arm.read_once()
        assert arm.state.q_d == pytest.approx(target, abs=1e-9)

    def test_motion_survives_one_packet_less_than_the_limit(
        self, arm: RobotArm
    ) -> None:
        lose(arm, MOST_LOST_PACKETS - 1)
        hold(arm)
        assert mode_of(arm) is RobotMode.MOVE
        assert arm.errors() == []

    def test_lost_packets_in_a_row_end_the_motion(self, arm: RobotArm) -> None:
        lose(arm, MOST_LOST_PACKETS + 1)

        assert mode_of(arm) is RobotMode.REFLEX
        assert error_names(arm.state.current_errors) == [LOST]
        assert [error.name for error in arm.errors()] == [LOST]
        assert 1 <= len(arm.log()) <= 50
        assert arm.remedy() is not None

    def test_arm_with_an_error_moves_only_after_a_recovery(self, arm: RobotArm) -> None:
        lose(arm, MOST_LOST_PACKETS + 1)
        assert arm.refusal(JOINT, POSITION) is not None
        with pytest.raises(ArmCommandError):
            arm.start_motion(JOINT, POSITION)
        with pytest.raises(ArmCommandError):
            arm.command_joint_positions(list(arm.state.q_d))

        arm.check_recovery()
        arm.automatic_error_recovery()
        for _ in range(1_000):
            arm.read_once()

        assert mode_of(arm) is RobotMode.IDLE
        assert not any(arm.state.current_errors)
        assert arm.remedy() is None
        arm.start_motion(JOINT, POSITION)
        assert arm.errors() == []

    def test_recovery_without_an_error_changes_nothing(self, arm: RobotArm) -> None:
        arm.check_recovery()
        arm.automatic_error_recovery()
        assert mode_of(arm) is RobotMode.IDLE

    @pytest.mark.parametrize("setter", SETTERS)
    def test_setter_is_refused_while_a_motion_runs(
        self, arm: RobotArm, setter: str
    ) -> None:
        arm.start_motion(JOINT, POSITION)
        before = arm.state.copy()
        with pytest.raises(ArmCommandError):
            getattr(arm, setter)(SETTERS[setter])
        assert arm.state == before

        arm.stop_motion()
        getattr(arm, setter)(SETTERS[setter])

    def test_frames_and_load_show_in_the_state(
        self, arm: RobotArm, resolution: float
    ) -> None:
        for setter, value in SETTERS.items():
            getattr(arm, setter)(value)

        state = arm.state
        frames = SETTERS["set_end_effector_frame"], SETTERS["set_stiffness_frame"]
        for frame, shown in zip(frames, (state.NE_T_EE, state.EE_T_K), strict=True):
            assert shown == pytest.approx(frame, abs=resolution)
        assert state.m_load == 0.5
        assert state.m_total == pytest.approx(state.m_ee + 0.5)

    def test_model_agrees_with_the_refreshed_state(
        self, arm: RobotArm, resolution: float
    ) -> None:
        arm.set_end_effector_frame(END_EFFECTOR_FRAME)
        arm.read_once()
        arm.refresh_state()
        state, model = arm.state, arm.load_model()

        pose = model.pose(Frame.END_EFFECTOR, state.q, state.F_T_EE, state.EE_T_K)
        assert pose == pytest.approx(state.O_T_EE, abs=max(1e-9, 5 * resolution))
        mass = model.mass(state.q, state.I_total, state.m_total, state.F_x_Ctotal)
        assert len(mass) == 49
        assert [mass[7 * c + r] for r in range(7) for c in range(7)] == pytest.approx(
            mass
        )
        assert all(mass[8 * joint] > 0.0 for joint in range(7))

    def test_thresholds_can_be_set_again(self, arm: RobotArm) -> None:
        wide = CollisionBehavior(*((90.0,) * 7,) * 4, *((90.0,) * 6,) * 4)
        arm.set_collision_behavior(wide)
        arm.set_collision_behavior(DEFAULT_COLLISION_BEHAVIOR)
        arm.start_motion(JOINT, POSITION)
        hold(arm)
        assert mode_of(arm) is RobotMode.MOVE

    def test_user_stop_of_a_simulated_arm_refuses_motions_and_recovery(
        self, arm: RobotArm
    ) -> None:
        simulation = arm.simulation()
        if simulation is None:
            pytest.skip("people press the user stop of this arm")
        assert isinstance(simulation, ArmSimulation)
        arm.start_motion(JOINT, POSITION)
        simulation.set_user_stop(pressed=True)

        assert mode_of(arm) is RobotMode.USER_STOPPED
        assert arm.refusal(JOINT, POSITION) is not None
        with pytest.raises(ArmCommandError):
            arm.check_recovery()
        simulation.set_user_stop(pressed=False)
        assert mode_of(arm) is RobotMode.IDLE
