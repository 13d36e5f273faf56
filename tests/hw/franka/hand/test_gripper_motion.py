"""How fingers move and come to rest, with a motor that does what the test says."""

import pytest

from station.core.franka import GraspRequest, GripperActivity
from station.hw.franka.hand.gripper_motion import REST_DURATION, GripperMotion

STEP = 0.001


class FakeMotor:
    """Fingers that go to their width with the given speed, until something blocks."""

    def __init__(self, width: float = 0.08) -> None:
        self.width, self.target, self.speed, self.time = width, width, 0.0, 0.0
        self.narrowest, self.widest = 0.0, 0.08
        self.velocity = 0.0
        self.pressed: list[float] = []

    def read_position(self) -> float:
        return self.width / 2.0

    def read_velocity(self) -> float:
        return self.velocity / 2.0

    def read_time(self) -> float:
        return self.time

    def hold(self, width, *, speed, force):
        self.target, self.speed = width, speed

    def press(self, force, *, is_damped):
        assert is_damped
        self.pressed.append(force)
        self.target = self.width

    def step(self) -> None:
        """Let a step of time pass."""
        before, way = self.width, self.target - self.width
        self.width += min(max(way, -self.speed * STEP), self.speed * STEP)
        self.width = min(max(self.width, self.narrowest), self.widest)
        self.velocity = (self.width - before) / STEP
        self.time += STEP


@pytest.fixture
def motor():
    return FakeMotor()


@pytest.fixture
def motion(motor):
    return GripperMotion(motor, 0.08)


def run(motor, motion, seconds=20.0):
    """Return the outcome, and when the fingers had come to rest [s]."""
    moved = motor.time
    for _ in range(round(seconds / STEP)):
        motor.step()
        if motor.velocity:
            moved = motor.time
        outcome = motion.advance()
        if outcome is not None:
            return outcome, moved
    raise AssertionError("it goes on")


def test_a_move_ends_when_the_width_is_reached(motor, motion):
    motion.move(0.02, 0.1)

    outcome, _ = run(motor, motion)

    assert outcome.message is None
    assert motion.activity is GripperActivity.IDLE
    assert motion.width() == pytest.approx(0.02, abs=1.1e-3)


@pytest.mark.parametrize("speed", [0.1, 0.01, 0.002])
def test_an_obstacle_ends_a_move_at_once_at_every_speed(motor, motion, speed):
    motor.narrowest = 0.07
    motion.move(0.02, speed)

    outcome, moved = run(motor, motion)

    assert "blocks the fingers at 0.0700 m" in outcome.message
    assert motor.time - moved == pytest.approx(REST_DURATION, abs=2 * STEP)
    assert motor.pressed == [0.0]


def test_a_grasp_keeps_pressing_inwards(motor, motion):
    motor.narrowest = 0.03
    motion.grasp(GraspRequest(0.03, 20.0))

    outcome, _ = run(motor, motion)

    assert outcome.message is None
    assert motion.activity is GripperActivity.HOLDING
    assert motion.is_grasped()
    assert motor.pressed == [-20.0]
    assert motion.advance() is None


@pytest.mark.parametrize("narrowest", [0.0, 1.7e-13])
def test_a_grasp_of_air_fails_where_the_epsilon_begins_at_the_closed_hand(
    motor, motion, narrowest
):
    motor.narrowest = narrowest

    motion.grasp(GraspRequest(0.005, 20.0, 0.1, 0.005, 0.005))
    outcome, _ = run(motor, motion)

    assert "came to rest at 0.0000 m" in outcome.message
    assert not motion.is_grasped()
    assert motor.pressed == [0.0]


def test_a_grasp_from_within_presses_outwards(motor, motion):
    motor.width, motor.widest = 0.0, 0.05
    motion.grasp(GraspRequest(0.05, 20.0))

    outcome, _ = run(motor, motion)

    assert outcome.message is None
    assert motor.pressed == [20.0]


def test_an_object_that_slips_out_is_no_longer_grasped(motor, motion):
    motor.narrowest = 0.03
    motion.grasp(GraspRequest(0.03, 20.0))
    run(motor, motion)

    motor.width = 0.01

    assert not motion.is_grasped()
    assert motion.activity is GripperActivity.HOLDING


def test_homing_closes_the_hand_and_then_opens_it(motor, motion):
    motor.widest = 0.0795
    motion.home()

    outcome, _ = run(motor, motion)

    assert outcome.message is None
    assert motion.max_width == pytest.approx(0.0795)


def test_homing_ends_at_an_obstacle(motor, motion):
    motor.narrowest = 0.03
    motion.home()

    outcome, _ = run(motor, motion)

    assert "blocks" in outcome.message
    assert motion.max_width == 0.08


def test_fingers_at_rest_hold_their_width(motor, motion):
    motion.move(0.02, 0.1)
    for _ in range(100):
        motor.step()
        motion.advance()
    motion.rest()
    for _ in range(200):
        motor.step()
        assert motion.advance() is None

    assert motor.target == pytest.approx(0.07, abs=1e-3)
    assert motor.pressed == [0.0]


def test_a_given_up_motor_is_left_alone(motor, motion):
    motion.rest()
    motion.give_up()
    motor.target = 0.5
    for _ in range(200):
        motor.step()
        motion.advance()

    assert motor.target == 0.5
