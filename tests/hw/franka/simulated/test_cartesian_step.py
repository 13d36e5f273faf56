"""The cycle of a Cartesian motion: the same bits in both modes."""

from dataclasses import replace

import pytest
from hypothesis import given, settings, strategies as st

from station.core.franka import Frame, RobotState
from station.hw.franka.arm.arm_limits import PANDA_LIMITS, MotionLimits
from station.hw.franka.arm.franka_kinematics import CHAIN, frame_pose
from station.hw.franka.arm.transform_check import transform_problem
from station.hw.franka.simulated.cartesian_step import is_transform
from station.memory.doubles import doubles, put
from tests.both_modes import arrays, assert_same, needs_both, sibling

PERIOD = 0.001
START = [0.0, -0.8, 0.0, -2.3, 0.0, 1.5, 0.8]
POSE = frame_pose(Frame.END_EFFECTOR, START)
LIMITS = replace(
    PANDA_LIMITS,
    lower=(-3.0,) * 7,
    upper=(3.0,) * 7,
    translation=MotionLimits(1.7, 13.0, 6500.0),
)


class Motion:
    """A Cartesian step and the memory it reads and writes, of one mode's modules."""

    def __init__(self, module) -> None:
        memory = sibling(module, "joint_memory").JointMemory(7, q_d=doubles(START))
        check = sibling(module, "motion_check").MotionCheck(memory, LIMITS, PERIOD)
        self.memory, self.violations = memory, check.violations
        names = ("O_T_EE_c", "O_dP_EE_c", "O_ddP_EE_c", "elbow_c", "delbow_c")
        state = RobotState(O_T_EE_c=POSE, elbow_c=[0.0, -1.0])
        self.parts = {name: state.doubles(name) for name in (*names, "ddelbow_c")}
        self.step = module.CartesianStep(memory, check, state.doubles, CHAIN, PERIOD)

    def follow(self, *, may_settle: bool = True) -> int:
        """Follow the command; return the number of violations."""
        self.violations.count = 0
        return self.step.follow_command(False, may_settle)  # noqa: FBT003

    def everything(self) -> list[float]:
        """Return all numbers that a cycle can change."""
        found = [*self.memory.target]
        for part in self.parts.values():
            found += part
        return found


@needs_both
@settings(max_examples=60, deadline=None)
@given(
    scale=st.sampled_from([1e-5, 1e-3, 1.0, 1e200]),
    commands=st.lists(arrays(6), min_size=1, max_size=3),
    state=arrays(12),
    as_pose=st.booleans(),
    has_elbow=st.booleans(),
)
def test_both_modes_give_the_same_bits(scale, commands, state, as_pose, has_elbow):
    def scenario(module):
        motion = Motion(module)
        step = motion.step
        put(motion.parts["O_dP_EE_c"], [scale * value for value in state[:6]])
        put(motion.parts["O_ddP_EE_c"], [scale * value for value in state[6:]])
        step.has_elbow = has_elbow
        found = []
        for command in commands:
            values = [scale * value for value in command]
            if as_pose:
                values = [
                    *POSE[:12],
                    *(POSE[12 + i] + values[i] for i in range(3)),
                    1.0,
                ]
            put(step.command[: len(values)], values)
            step.size = len(values)
            found += [motion.follow(), *motion.everything()]
            found += [step.extrapolate(), *motion.everything()]
            for error in motion.violations.errors():
                found += [error.value, error.limit]
        return found

    assert_same("cartesian_step", scenario)


@given(st.lists(st.floats(-2.0, 2.0), min_size=16, max_size=16), st.integers(0, 17))
def test_transforms_are_told_from_other_numbers(values, where):
    pose = list(POSE)
    if where < 16:
        pose[where] += 1e-5 * values[where]
    assert is_transform(doubles(pose)) is (transform_problem(pose) is None)
    assert is_transform(doubles(values)) is (transform_problem(values) is None)


@pytest.mark.parametrize("size", [6, 16])
def test_rest_is_followed(size):
    from station.hw.franka.simulated import cartesian_step

    motion = Motion(cartesian_step)
    motion.step.size = size
    put(motion.step.command[:size], [0.0] * 6 if size == 6 else POSE)
    assert motion.follow() == 0
    assert [*motion.memory.target] == pytest.approx(START, abs=1e-9)
    assert [*motion.parts["O_T_EE_c"]] == pytest.approx(POSE, abs=1e-12)


def settled_motion():
    """Return a motion that has come to rest where its command is."""
    from station.hw.franka.simulated import cartesian_step

    motion = Motion(cartesian_step)
    motion.step.size = 16
    put(motion.step.command, POSE)
    for _ in range(5):
        assert motion.follow() == 0
        put(motion.memory.q_d, motion.memory.target)
    return motion


def test_a_pose_that_was_reached_asks_for_no_motion():
    motion = settled_motion()
    before, kinematics = motion.everything(), [*motion.step.next_pose]
    assert motion.step.is_settled
    put(motion.step.next_pose, [7.0] * 16)  # nobody computes a next pose

    assert motion.follow() == 0
    assert motion.everything() == before
    assert [*motion.step.next_pose] == [7.0] * 16 != kinematics


@pytest.mark.parametrize("change", ["pose", "twist", "disturbance", "extrapolation"])
def test_whatever_else_comes_is_computed(change):
    motion = settled_motion()
    step = motion.step
    put(step.next_pose, [7.0] * 16)
    if change == "pose":
        step.command[12] += 1e-9
        assert motion.follow() == 0
        assert not step.is_settled  # it moves
    elif change == "twist":
        step.size = 6
        put(step.command[:6], [0.0] * 6)
        assert motion.follow() == 0
    elif change == "disturbance":
        assert motion.follow(may_settle=False) == 0
        assert not step.is_settled
    else:
        step.extrapolate()
        assert not step.is_settled
        assert motion.follow() == 0
    assert [*step.next_pose] == pytest.approx(
        [*step.command] if change == "pose" else POSE
    )


def test_rest_is_told_from_a_slow_motion():
    motion = settled_motion()
    for _ in range(3):  # 1 um/s
        motion.step.command[12] += 1e-9
        assert motion.follow() == 0
        put(motion.memory.q_d, motion.memory.target)
    assert not motion.step.is_settled
