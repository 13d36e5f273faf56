"""Robots of gymnasium-robotics, per step of the simulation.

Runs in an environment of its own, which benchmarks/bench_peers.py makes. An environment
makes many steps of the simulation in one call for each action.
"""

import json
import logging
import sys
import warnings

import mujoco

warnings.simplefilter("ignore")
logging.disable(logging.WARNING)

import gymnasium  # noqa: E402
import gymnasium_robotics  # noqa: E402
import numpy as np  # noqa: E402
from paired_timing import Effort, ask_for_processor, measure_hot  # noqa: E402

KIND = mujoco.mjtState.mjSTATE_INTEGRATION
ENVIRONMENTS = {"FetchReach-v4": "n_substeps", "FrankaKitchen-v1": "frame_skip"}


def measure(name: str) -> dict[str, object]:
    """Return the row of an environment."""
    gymnasium.register_envs(gymnasium_robotics)
    env = gymnasium.make(name, max_episode_steps=10**9)
    env.reset(seed=1)
    inner = env.unwrapped
    inner = getattr(inner, "robot_env", inner)
    model, data = inner.model, inner.data
    substeps = int(getattr(inner, ENVIRONMENTS[name]))
    action = np.zeros(env.action_space.shape)
    copy = mujoco.MjData(model)
    state = np.zeros(mujoco.mj_stateSize(model, KIND))

    def begin() -> None:
        mujoco.mj_getState(model, data, state, KIND)
        mujoco.mj_setState(model, copy, state, KIND)

    def step(count: int) -> None:
        for _ in range(count):
            mujoco.mj_step(model, copy)

    def cycle(count: int) -> None:
        for _ in range(count // substeps):
            env.step(action)

    cycle(20 * substeps)
    turns = measure_hot(step, cycle, begin, Effort(calls=20 * substeps))
    return {
        "robot": f"gymnasium-robotics {gymnasium_robotics.__version__}",
        "controller": f"{name}, an action per {substeps} steps",
        "mode": f"MuJoCo {mujoco.__version__}",
        "temperature": "hot",
        **turns.row(),
    }


if __name__ == "__main__":
    ask_for_processor()
    json.dump([measure(name) for name in ENVIRONMENTS], sys.stdout)
