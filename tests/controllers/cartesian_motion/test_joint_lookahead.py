"""A step is allowed when the joints can go on to rest."""

import pytest

from station.controllers.cartesian_motion import CartesianJogController
from station.controllers.cartesian_motion.joint_lookahead import Obstacle

NEAR_LIMIT = [0.0, -0.785, 0.0, -2.356, 2.84, 1.571, 0.785]


def lookahead_of(arm, **values):
    controller = arm.start(CartesianJogController, **values)
    return controller, controller.lookahead


def steps(controller, lookahead, twist, cycles):
    """Return whether each of some steps at a twist is allowed."""
    motion = controller.generator
    motion.go_at(twist)
    allowed = []
    for _ in range(cycles):
        motion.advance(0.001)
        allowed.append(lookahead.allows(motion.motion))
    return allowed


def test_in_the_middle_everything_is_allowed(arm):
    controller, lookahead = lookahead_of(arm)

    assert all(steps(controller, lookahead, [0.05, 0.0, 0.0, 0.0, 0.0, 0.1], 200))
    assert lookahead.obstacle is Obstacle.NONE


def test_a_joint_near_its_limit_is_named_and_may_go_back(make_arm):
    controller, lookahead = lookahead_of(make_arm(NEAR_LIMIT), joint_limit_margin=0.1)
    motion = controller.generator
    start = [*motion.pose]
    found = set()
    for sign in (1.0, -1.0):
        for axis in range(3, 6):
            motion.start(start)
            lookahead.start(controller.handle.get_robot_state())
            twist = [0.0] * 6
            twist[axis] = 0.2 * sign
            allowed = steps(controller, lookahead, twist, 30)
            found.add((all(allowed), lookahead.obstacle, lookahead.joint))

    assert (False, Obstacle.JOINT_LIMIT, "panda_joint5") in found
    assert (True, Obstacle.NONE, None) in found


def test_a_joint_that_would_be_too_fast_is_named(arm):
    controller, lookahead = lookahead_of(arm, joint_velocity_share=0.01)

    assert not all(steps(controller, lookahead, [0.0, 0.0, 0.0, 0.0, 0.0, 0.5], 400))
    assert lookahead.obstacle is Obstacle.JOINT_SPEED
    assert lookahead.joint.startswith("panda_joint")


def test_less_dexterity_than_asked_for_is_a_singularity(arm):
    controller, lookahead = lookahead_of(arm, least_dexterity=0.9)
    allowed = [
        all(steps(controller, lookahead, [sign * 0.05, 0, 0, 0, 0, 0], 400))
        for sign in (1.0, -1.0)
    ]

    # Where it is, it is below already: only the way to more of it is free.
    assert allowed.count(False) >= 1


def test_parts_of_the_arm_do_not_come_near_each_other(make_arm):
    # The hand beside link 5, 6 cm away.
    arm = make_arm([-0.62, -0.11, 0.0, -2.78, 1.69, 0.51, 0.08])
    controller, lookahead = lookahead_of(arm)

    assert not all(steps(controller, lookahead, [0.0, 0.0, 0.0, 0.5, 0.0, 0.0], 800))
    assert lookahead.obstacle is Obstacle.SELF_COLLISION
    assert lookahead.joint is None


@pytest.mark.parametrize("bound", [0.5, 7.0])
def test_accelerations_of_joints_are_bounded(arm, send, bound):
    controller = arm.start(CartesianJogController, max_joint_acceleration=bound)
    largest = 0.0
    for _ in range(10):
        send(controller, [0.2, 0.0, 0.0, 0.0, 0.0, 0.5])
        for _ in range(50):
            arm.run(controller, 1)
            largest = max(largest, *map(abs, arm.state.ddq_d))

    assert largest <= 1.2 * bound
