"""Any controller's set-points are the actions of a Gymnasium environment."""

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import station.gym
from station.core.errors import InvalidCommandError, ParameterError
from station.gym import StationEnv

GROUP = "effort_group_position_controller"
ENV = f"{station.gym.__name__}:Station-v0"
# Set-points have units; who wants them from -1 to 1 wraps the environment.
UNITS = "ignore:.*we recommend using a symmetric and normalized space:UserWarning"


@pytest.fixture
def make():
    """Return a function that makes an environment, closed at the end."""
    made = []

    def make(**options):
        made.append(StationEnv(**options))
        return made[-1]

    yield make
    for env in made:
        env.close()


@pytest.mark.slow
@pytest.mark.filterwarnings(UNITS)
@pytest.mark.parametrize("dtype", ["float64", "float32"])
@pytest.mark.parametrize(
    "controller",
    [
        GROUP,
        "effort_group_effort_controller",
        "velocity_group_controller",
        "position_streaming_controller",
        "position_jog_controller",
        "cartesian_streaming_controller",
        "cartesian_jog_controller",
    ],
)
def test_gymnasiums_own_checker_finds_nothing(controller, dtype):
    env = gymnasium.make(ENV, controller=controller, dtype=dtype)
    check_env(env.unwrapped)
    env.close()


@pytest.mark.slow
def test_two_of_them_are_stepped_together():
    envs = gymnasium.make_vec(ENV, num_envs=2, vectorization_mode="sync", noise=0.01)
    observation, _ = envs.reset(seed=3)
    _, reward, terminated, truncated, _ = envs.step(envs.action_space.sample())
    envs.close()

    assert observation["position"].shape == (2, 7)
    assert not np.array_equal(*observation["position"])
    assert reward.shape == terminated.shape == truncated.shape == (2,)


def test_robot_goes_where_the_actions_say(make):
    env = make(
        controller=GROUP,
        seconds=1.0,
        reward=lambda o, _: -abs(o["position"][0]),
        settings={"robot.realism": "ideal"},  # no friction keeps it from the target
    )
    first, _ = env.reset()
    wanted = first["position"].copy()
    wanted[0] = 0.2

    steps = [env.step(wanted) for _ in range(50)]

    observation, rewarded, terminated, truncated, info = steps[-1]
    assert observation["position"] == pytest.approx(wanted, abs=2e-3)
    assert rewarded == -abs(observation["position"][0])
    assert (terminated, truncated, info) == (False, True, {"time": pytest.approx(1.0)})
    assert not any(step[3] for step in steps[:-1])


def test_episode_ends_when_the_task_says_so(make):
    env = make(controller=GROUP, terminated=lambda o: o["position"][0] > 0.05)
    first, _ = env.reset(options={"joint_positions": {"panda_joint1": 0.1}})

    assert first["position"][0] == pytest.approx(0.1, abs=1e-3)
    assert env.step(first["position"])[2]


def test_controller_that_gives_up_ends_the_episode_and_a_reset_begins_anew(make):
    env = make(controller=GROUP)
    first, _ = env.reset()
    env.station.facade.stop("somebody pressed stop")
    env.station.step()

    _, _, terminated, _, info = env.step(first["position"])
    assert terminated
    assert "stopped" in info["fault"] or "initialized" in info["fault"]

    env.station.facade.release_stop(arm=False)
    env.station.facade.release_stop(arm=True)
    again, _ = env.reset()
    assert again["position"] == pytest.approx(first["position"], abs=1e-9)
    assert not env.step(again["position"])[2]


def test_action_that_is_not_finite_is_refused(make):
    env = make(controller=GROUP)
    env.reset()

    with pytest.raises(InvalidCommandError):
        env.step(np.full(7, np.nan))


def test_action_of_another_shape_is_refused(make):
    env = make(controller=GROUP)
    env.reset()

    with pytest.raises(InvalidCommandError, match="takes 7 finite numbers"):
        env.step(np.zeros(6))


@pytest.mark.parametrize("dtype", ["float64", "float32"])
def test_action_outside_of_the_space_is_clipped_to_it(make, dtype):
    """As Pendulum and MountainCarContinuous do."""
    rewarded = []
    env = make(
        controller=GROUP,
        dtype=dtype,
        reward=lambda _, action: rewarded.append(action) or 0.0,
    )
    env.reset()
    far = np.full(7, 100.0, dtype=dtype)
    *_, info = env.step(far)

    elements = env.station.facade.motion.set_point(GROUP).elements
    assert rewarded[0].tolist() == [element.maximum for element in elements]
    assert "fault" not in info
    assert env.action_space.contains(rewarded[0].astype(dtype))


def test_observations_have_the_limits_of_the_joints_as_bounds(make):
    env = make(controller=GROUP)
    space = env.observation_space
    for report in env.station.facade.loop.hw.joint_limits():
        joint = env.station.joint_names.index(report.joint)
        limits = report.limits
        assert space["position"].low[joint] == limits.min_position
        assert space["position"].high[joint] == limits.max_position
        assert space["velocity"].high[joint] == limits.max_velocity
        assert space["effort"].high[joint] == limits.max_effort
    assert np.isfinite(space["velocity"].high).all()


@pytest.mark.parametrize("dtype", ["float64", "float32"])
def test_every_observation_is_within_the_space(make, dtype):
    """Also of a joint that is pressed into its stop, whose place is beyond."""
    env = make(controller="effort_group_effort_controller", dtype=dtype, noise=0.01)
    observation, _ = env.reset(seed=1)
    assert observation["position"].dtype == np.dtype(dtype)
    for _ in range(100):
        assert env.observation_space.contains(observation)
        observation, *_ = env.step(env.action_space.high)


def test_another_precision_is_refused():
    with pytest.raises(ParameterError, match="float64 or float32"):
        StationEnv(controller=GROUP, dtype="float16")


def test_controller_without_set_points_is_refused():
    with pytest.raises(InvalidCommandError, match="takes no set-points"):
        StationEnv(controller="effort_joint_trajectory_controller")
