"""The guard of a chain in memory of its own, in both modes."""

from math import pi

import pytest
from hypothesis import given, settings, strategies as st

from station.core.description.urdf import Pose
from station.core.geometry.clearances import Clearances
from station.core.geometry.guard import Guard
from station.core.geometry.scene import SceneObject, solid_of
from station.memory.doubles import doubles, put, zeros
from tests.both_modes import assert_same, needs_both, sibling

# Two joints about z, links of 0.5 m along x: in Craig's convention the second one and
# the flange are moved along x.
CHAIN = [0.0, 0.0, 1.0, 0.0, 0.5, 0.0, 1.0, 0.0, 0.5, 0.0, 1.0, 0.0]
CAPSULES = [0.0, 0.0, 0.0, 0.5, 0.0, 0.0, 0.05] * 2
WALL = SceneObject(
    "wall", "box", (0.2, 4.0, 2.0), (0.0, 0.8, 0.0), (0.0, 0.0, pi / 2),
    role="keep_out", margin=0.05,
)  # fmt: skip
SIZES = {"q_d": 2, "dq_d": 2, "ddq_d": 2, "q": 2, "dq": 2, "tau_J_d": 2}
POSES = {"O_T_EE_c": 16, "O_dP_EE_c": 6, "O_ddP_EE_c": 6}


def make(kind=Guard, things=(WALL,), measure=Clearances) -> Guard:
    memory = {name: zeros(size) for name, size in {**SIZES, **POSES}.items()}
    guard = kind(
        measure(doubles(CHAIN), CAPSULES, [0, 1]),
        ["upper", "lower"],
        memory,
        velocity=[2.0, 2.0],
        acceleration=[10.0, 10.0],
        jerk=[5000.0, 5000.0],
        torque_step=1.0,
        translation=[2.0, 13.0, 2.5, 25.0],
        period=0.001,
    )
    guard.set_scene(
        [number for one in things for number in solid_of(one, Pose(), [])],
        [],
        [one.name for one in things],
    )
    return guard


def drive(guard: Guard, velocities, cycles: int) -> list[float]:
    """Let the joints follow velocity commands exactly; return where they end."""
    memory, command = guard.memory, zeros(2)
    for _ in range(cycles):
        put(command, velocities)
        guard.limit_velocities(command)
        for i in range(2):
            change = (command[i] - memory["dq_d"][i]) / 0.001
            memory["ddq_d"][i] = change
            memory["dq_d"][i] = command[i]
            memory["q_d"][i] += 0.001 * command[i]
    return [*memory["q_d"]]


def test_an_arm_stops_at_the_margin_of_a_wall():
    guard = make()
    q = drive(guard, [1.0, 0.0], 1500)
    # Stretched out at 1 m from its axis the arm touches the margin at this height.
    assert guard.clearances.distance == pytest.approx(0.05, abs=1e-3)
    assert guard.clearances.distance >= 0.05 - 1e-6
    assert q[0] < 1.0
    assert guard.is_slowing
    assert guard.things[guard.clearances.pair % guard.clearances.solid_count] == "wall"


def test_an_arm_leaves_a_wall_at_full_speed():
    guard = make()
    drive(guard, [1.0, 0.0], 1500)
    before = guard.memory["q_d"][0]
    q = drive(guard, [-1.0, 0.0], 1000)
    assert before - q[0] > 0.9
    assert not guard.is_slowing


def test_commands_that_stay_clear_pass_bit_for_bit():
    guard, command = make(), doubles([-0.7, 0.3])
    guard.limit_velocities(command)
    assert [*command] == [-0.7, 0.3]
    assert guard.interventions == 0
    assert guard.clearances.pair >= 0


def test_a_fence_holds_the_arm_inside():
    fence = SceneObject(
        "cell", "box", (4.0, 1.4, 2.0), role="fence", margin=0.05, solid=False
    )
    guard = make(things=(fence,))
    drive(guard, [1.0, 0.0], 1500)
    assert guard.clearances.distance == pytest.approx(0.05, abs=1e-3)


def test_a_role_for_some_links_lets_others_pass():
    guard = make()
    guard.allow(0, ["upper"])
    q = drive(guard, [1.0, 0.0], 1500)
    assert q[0] == pytest.approx(1.5)
    assert guard.interventions == 0


def test_torques_push_away_and_end_in_a_reflex_that_names_the_pair():
    guard = make()
    put(guard.memory["q"], [0.6, 0.0])
    torques = zeros(2)
    assert guard.limit_torques(torques)
    put(guard.memory["dq"], [1.9, 0.0])
    assert not guard.limit_torques(torques)
    assert guard.reflex() == (
        "guard_reflex: lower would have come nearer than 50 mm to 'wall'"
    )


def test_two_arms_that_swing_at_each_other_keep_their_distance():
    left, right = make(things=()), make(things=())
    # The other base is 1.6 m away along x, turned by half a turn.
    place = [-1.0, 0, 0, 0, 0, -1.0, 0, 0, 0, 0, 1.0, 0, 1.6, 0, 0, 1.0]
    left.add_neighbour(right, doubles(place), "right")
    right.add_neighbour(left, doubles(place), "left")
    for guard, q in ((left, [1.2, 0.0]), (right, [-1.2, 0.0])):
        put(guard.memory["q_d"], q)
        guard.set_scene([], [], [], 0.05)
    closest = 9.0
    for _ in range(700):
        drive(left, [-1.5, 0.0], 1)
        drive(right, [1.5, 0.0], 1)
        closest = min(closest, left.clearances.distance, right.clearances.distance)

    assert 0.05 - 1e-3 <= closest < 0.07
    assert left.is_slowing
    assert right.is_slowing
    assert left.things[left.clearances.pair % left.clearances.solid_count].startswith(
        "right "
    )


@needs_both
@settings(max_examples=25)
@given(st.lists(st.floats(-1.5, 1.5), min_size=6, max_size=6))
def test_both_modes_agree_bit_for_bit(values):
    def scenario(module):
        guard = make(module.Guard, measure=sibling(module, "clearances").Clearances)
        put(guard.memory["q_d"], values[:2])
        put(guard.memory["q"], values[:2])
        put(guard.memory["dq_d"], values[2:4])
        put(guard.memory["dq"], values[2:4])
        found = []
        for method in ("limit_velocities", "limit_positions", "limit_torques"):
            command = doubles(values[4:])
            getattr(guard, method)(command)
            found += [*command, guard.clearances.distance, float(guard.clearances.pair)]
        twist = doubles([*values])
        guard.limit_twist(twist)
        return [*found, *guard.twist, float(guard.interventions)]

    assert_same("guard", scenario)
