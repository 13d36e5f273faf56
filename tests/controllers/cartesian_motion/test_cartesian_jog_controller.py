"""A held button moves the end effector, and never into an error of the arm."""

from random import Random

import pytest

from station.controllers.cartesian_motion import CartesianJogController
from station.controllers.cartesian_motion.cartesian_limits import ROTATION, TRANSLATION
from station.core.errors import InvalidCommandError, InvalidGainError, ParameterError
from station.core.numerics.poses import to_outer_axes
from tests.controllers.cartesian_motion.conftest import length

FAST, TURN = TRANSLATION.velocity, ROTATION.velocity
DIRECTIONS = [
    [sign * speed if axis == index else 0.0 for axis in range(6)]
    for index, speed in enumerate([FAST] * 3 + [TURN] * 3)
    for sign in (1.0, -1.0)
]


def hold(arm, controller, send, twist, cycles, every=100):
    """Send a twist again and again, as a held button does."""
    for _ in range(cycles // every):
        send(controller, twist)
        arm.run(controller, every)


def test_a_held_button_moves_at_its_speed_and_letting_go_stops(arm, send):
    controller = arm.start(CartesianJogController)
    start = list(arm.state.O_T_EE_d)
    hold(arm, controller, send, [0.0, 0.1, 0.0, 0.0, 0.0, 0.2], 1_000)
    assert arm.state.O_dP_EE_c == pytest.approx([0, 0.1, 0, 0, 0, 0.2], abs=1e-9)
    arm.run(controller, 101)  # the last heartbeat is valid until here
    assert arm.state.O_dP_EE_c[1] == pytest.approx(0.1, abs=1e-3)
    arm.run(controller, 500)
    held = list(arm.state.O_T_EE_d)
    arm.run(controller, 200)

    assert arm.state.O_T_EE_d == pytest.approx(held, abs=1e-9)
    assert held[13] - start[13] == pytest.approx(0.1 * 1.1, abs=0.01)
    assert arm.errors == []


def test_zero_stops_without_waiting_for_the_watchdog(arm, send):
    controller = arm.start(CartesianJogController)
    hold(arm, controller, send, [0.1, 0.0, 0.0, 0.0, 0.0, 0.0], 500)
    hold(arm, controller, send, [0.0] * 6, 300)

    assert max(abs(value) for value in arm.state.O_dP_EE_c) < 1e-9


@pytest.mark.long
@pytest.mark.parametrize("direction", DIRECTIONS)
def test_a_button_held_for_ever_ends_at_rest_and_without_an_error(arm, send, direction):
    controller = arm.start(CartesianJogController)
    hold(arm, controller, send, direction, 6_000)

    assert arm.errors == []
    assert max(abs(value) for value in arm.state.O_dP_EE_c) < 1e-2
    state = controller.published()["state"]
    assert state["obstacle"] not in {"", "none"}
    assert state["message"]
    back = [-0.2 * value for value in direction]
    hold(arm, controller, send, back, 1_000)
    assert max(abs(value) for value in arm.state.O_dP_EE_c) > 0.01
    assert arm.errors == []


@pytest.mark.parametrize("seed", [3, 4])
def test_limits_hold_over_random_twists(arm, send, seed):
    random = Random(seed)
    controller = arm.start(CartesianJogController)
    for _ in range(30):
        twist = []
        for speed in (FAST, TURN):
            vector = [random.gauss(0.0, 1.0) for _ in range(3)]
            scale = speed * random.random() ** 0.3 / length(vector)
            twist += [scale * value for value in vector]
        hold(arm, controller, send, twist, random.choice([20, 40, 100]), 20)

    assert arm.errors == []
    for order, name in enumerate(["velocity", "acceleration", "jerk"], start=1):
        for found, limits in zip(
            arm.rates(order), (TRANSLATION, ROTATION), strict=True
        ):
            # Third differences of rounded poses are off by some 1e-6.
            assert found <= getattr(limits, name) * (1.0 + 1e-6) + 1e-4


def test_axes_of_the_end_effector_can_be_chosen(arm, send):
    controller = arm.start(CartesianJogController, frame="EE")
    assert controller.tunables.values == {"frame": 1.0}
    hold(arm, controller, send, [0.1, 0.0, 0.0, 0.0, 0.0, 0.0], 500)

    along = to_outer_axes(arm.state.O_T_EE_d, [0.1, 0.0, 0.0])
    assert arm.state.O_dP_EE_c[:3] == pytest.approx(along, abs=1e-9)
    assert controller.sample.desired == pytest.approx([0.1, 0, 0, 0, 0, 0], abs=1e-9)
    assert controller.sample.actual == pytest.approx([0.1, 0, 0, 0, 0, 0], abs=1e-3)


def test_the_axes_can_be_changed_at_run_time(arm):
    controller = arm.start(CartesianJogController)
    controller.tunables.checked({"frame": 1.0})
    controller.tunables.apply({"frame": 1.0})

    assert controller.tunables.values == {"frame": 1.0}
    with pytest.raises(InvalidGainError, match="0 or 1"):
        controller.tunables.checked({"frame": 0.5})


def test_other_axes_hold_for_the_set_point_in_force(arm, send):
    controller = arm.start(CartesianJogController)
    send(controller, [0.0, 0.0, 0.01, 0.0, 0.0, 0.0])
    arm.run(controller, 20)
    controller.tunables.apply({"frame": 1.0})
    arm.run(controller, 170)

    along = to_outer_axes(arm.state.O_T_EE_d, [0.0, 0.0, 0.01])
    assert along[2] < -0.005
    assert arm.state.O_dP_EE_c[:3] == pytest.approx(along, abs=1e-3)


def test_other_axes_are_refused(arm):
    with pytest.raises(ParameterError, match="'K'; it must be one of O, EE"):
        arm.load(CartesianJogController, frame="K")


def test_a_twist_beyond_the_limits_is_refused(arm, send):
    controller = arm.start(CartesianJogController)

    with pytest.raises(InvalidCommandError, match=r"'vx' is 0\.31"):
        send(controller, [0.31, 0.0, 0.0, 0.0, 0.0, 0.0])
    with pytest.raises(InvalidCommandError, match=r"0\.4243 m/s long"):
        send(controller, [0.3, 0.3, 0.0, 0.0, 0.0, 0.0])
    with pytest.raises(InvalidCommandError, match=r"rad/s long"):
        send(controller, [0.0, 0.0, 0.0, 0.9, 0.9, 0.0])


def test_the_sample_is_a_twist(arm):
    controller = arm.start(CartesianJogController)
    arm.run(controller, 1)

    assert controller.joint_names == ["vx", "vy", "vz", "wx", "wy", "wz"]
    assert controller.sample.desired == [0.0] * 6
