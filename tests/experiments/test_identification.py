"""Friction and inertia come out as they are in MuJoCo."""

import numpy as np
import pytest

from station.experiments.identification import identify
from station.experiments.trial_world import TrialWorld
from station.trials.errors import ExperimentError, UnknownParameterError
from station.trials.trial import Script, Setup, Trial
from station.wire.excitations import Multisine, Waypoints
from tests.experiments.conftest import GROUP

JOINT = "panda_joint7"
MOTION = Multisine(joint=JOINT, amplitude=0.3, frequencies=(0.7, 1.7, 3.1))


def move(world, **parameters):
    script = Script(controller=GROUP, duration=2.0, commands=(MOTION,))
    return world.record(Trial(world.setup, script, parameters))[1]


def test_known_friction_is_found(world):
    found = identify(
        move(world, **{f"friction/{JOINT}": 0.5, f"damping/{JOINT}": 1.5}), JOINT
    )

    # Half a cycle of the implicit integration is left between force and velocity.
    assert found.coulomb.value == pytest.approx(0.5, abs=0.01)
    assert found.viscous.value == pytest.approx(1.5, abs=0.01)
    assert found.residual < 0.01


def test_known_inertia_is_found(world):
    inertia = world.joint_inertia(JOINT)

    found = identify(move(world), JOINT)

    # The measured torque is that behind the rotor, as on a Franka.
    rotor = world.model().dof_armature[6]
    assert found.inertia.value == pytest.approx(inertia - rotor, rel=0.01)
    assert abs(found.coulomb.value) < 1e-3
    assert abs(found.viscous.value) < 1e-2


def test_confidence_covers_the_noise(world):
    parameters = {f"friction/{JOINT}": 0.5, "noise/velocity": 2e-3}

    found = identify(move(world, **parameters), JOINT, smoothing=15)

    assert found.coulomb.half_width > 1e-3
    assert found.coulomb.value == pytest.approx(0.5, abs=3.0 * found.coulomb.half_width)


def test_identified_friction_makes_an_arm_from_which_it_is_identified(tmp_path):
    path = tmp_path / "station.yaml"
    path.write_text(
        f"robot: {{identified: {{{JOINT}: {{coulomb: 0.8, viscous: 0.3}}}}}}\n"
    )
    with TrialWorld(Setup.load(path)) as world:
        found = identify(move(world), JOINT)
    assert found.coulomb.value == pytest.approx(0.8, abs=0.03)
    assert found.viscous.value == pytest.approx(0.3, abs=0.03)


def test_motion_one_way_does_not_show_friction(world):
    """Coulomb friction that never changes its sign looks like weight."""
    way = Waypoints(joint=JOINT, times=(1.0, 1.8), values=(0.5, 0.8))
    script = Script(controller=GROUP, duration=2.0, commands=(way,))
    trace = world.record(Trial(world.setup, script))[1]

    with pytest.raises(ExperimentError, match=r"moves one way in \d+% of the cycles"):
        identify(trace, JOINT)


def test_motions_that_tell_nothing_are_refused(world):
    trace = move(world)

    with pytest.raises(UnknownParameterError, match="no joint 'elbow'"):
        identify(trace, "elbow")
    still = Script(controller=GROUP, duration=0.2)
    resting = world.record(Trial(world.setup, still))[1]
    with pytest.raises(ExperimentError, match=r"moves in|does not tell"):
        identify(resting, JOINT)
    assert np.isfinite(trace.output).all()


@pytest.fixture(scope="module")
def erring(tmp_path_factory):
    """A world whose arm errs as a measured one: friction is no line over the speed."""
    path = tmp_path_factory.mktemp("erring") / "station.yaml"
    path.write_text("robot: {realism: typical}\n", encoding="utf-8")
    with TrialWorld(Setup.load(path, controllers=())) as made:
        yield made


@pytest.mark.slow
@pytest.mark.parametrize("number", [1, 2, 4])
def test_interval_has_the_inertia_of_an_arm_that_errs(erring, number):
    joint = f"panda_joint{number}"
    motion = Multisine(joint=joint, amplitude=0.1, frequencies=(0.5, 1.1, 1.9, 3.1))
    script = Script(controller=GROUP, duration=4.0, commands=(motion,))
    trace = erring.record(Trial(erring.setup, script, {}))[1]

    found = identify(trace, joint).inertia

    rotor = erring.model().dof_armature[number - 1]
    truth = erring.joint_inertia(joint) - rotor
    assert abs(found.value - truth) < 1.5 * found.half_width
    assert found.half_width < 0.03 * truth


def test_friction_is_never_negative(world):
    for number in (3, 6, 7):
        joint = f"panda_joint{number}"
        motion = Multisine(joint=joint, amplitude=0.1, frequencies=(0.7, 1.7, 3.1))
        script = Script(controller=GROUP, duration=2.0, commands=(motion,))
        found = identify(world.record(Trial(world.setup, script))[1], joint)

        assert min(found.coulomb.value, found.viscous.value) >= 0.0
        assert min(found.coulomb.half_width, found.viscous.half_width) > 0.0
