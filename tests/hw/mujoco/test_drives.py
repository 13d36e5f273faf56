"""Drives give the same bits in both modes, and act on the joints at their places."""

from array import array

from hypothesis import given, settings
from hypothesis import strategies as st

from station.hw.mujoco import drives as joint_drives
from station.memory.doubles import doubles
from tests.both_modes import both
from tests.core.hardware.limits.joints_of_limits import numbers, sizes

MEMORY = ("qpos", "qvel", "bias", "weight", "inertia", "control", "damping")
TARGETS = ("position_target", "velocity_target", "effort_target", "desired_velocity")
LIMITS = ("velocity_limit", "effort_limit", "lower_limit", "upper_limit")
PLACES = ("qpos", "dof", "inertia", "control", "damping")


@st.composite
def worlds(draw):
    """Return the memory, places and doubles of two joints in a world of three."""
    memory = {name: [draw(numbers) for _ in range(3)] for name in MEMORY}
    memory["inertia"] = [draw(st.floats(1e-6, 1e3)) for _ in range(3)]
    places = {name: draw(st.permutations([0, 1, 2]))[:2] for name in PLACES}
    own = {name: [draw(numbers) for _ in range(2)] for name in TARGETS}
    own |= {name: [draw(sizes) for _ in range(2)] for name in LIMITS}
    own["mode"] = [float(draw(st.integers(0, 2))) for _ in range(2)]
    return memory, places, own


def act(module, world):
    """Return the memory and the doubles after a step, with every sign."""
    memory, places, own = (
        {name: make(values) for name, values in part.items()}
        for make, part in zip((doubles, indices, doubles), world, strict=True)
    )
    module.Drives(memory, places, own, 0.001).prepare_step()
    return {name: repr(view.tolist()) for name, view in (memory | own).items()}


def indices(values):
    return memoryview(array("q", values))


def test_both_modes_agree_to_the_bit():
    interpreted, compiled = both("drives")

    @settings(derandomize=True)
    @given(worlds())
    def compare(world):
        assert act(interpreted, world) == act(compiled, world)

    compare()


def test_joint_is_read_and_driven_at_its_places():
    memory = {name: [0.0] * 3 for name in MEMORY} | {"inertia": [0.0, 0.0, 2.0]}
    memory |= {"qpos": [9.0, 0.25, 9.0], "bias": [5.0, 0.0, 0.0]}
    places = {"qpos": [1], "dof": [0], "inertia": [2], "control": [2], "damping": [0]}
    own = {name: [0.0] for name in (*TARGETS, "mode")}
    own |= {name: [1e9] for name in LIMITS} | {"position_target": [0.2500001]}

    after = act(joint_drives, (memory, places, own))

    # A servo of 1000/s over the inertia, 100/s from the target, and the bias.
    speed = 100.0 * (0.2500001 - 0.25)
    assert after["control"] == repr([0.0, 0.0, 2000.0 * speed + 5.0])
    assert after["damping"] == repr([-2000.0, 0.0, 0.0])
    assert after["desired_velocity"] == repr([speed])
