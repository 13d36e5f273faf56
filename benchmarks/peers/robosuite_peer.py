"""The Panda of robosuite under its own controllers, per step of the simulation.

Runs in an environment of its own, which benchmarks/bench_peers.py makes.
"""

import json
import logging
import sys
import warnings

import mujoco

warnings.simplefilter("ignore")
logging.disable(logging.WARNING)

import numpy as np  # noqa: E402
import robosuite  # noqa: E402
from paired_timing import Effort, ask_for_processor, measure_hot  # noqa: E402
from robosuite.controllers import load_part_controller_config  # noqa: E402
from robosuite.controllers.composite.composite_controller_factory import (  # noqa: E402
    refactor_composite_controller_config,
)

KIND = mujoco.mjtState.mjSTATE_INTEGRATION
CONTROLLERS = ("JOINT_TORQUE", "JOINT_POSITION", "OSC_POSE")


def measure(controller: str) -> dict[str, object]:
    """Return the row of a controller."""
    part = load_part_controller_config(default_controller=controller)
    config = refactor_composite_controller_config(part, "Panda", ["right"])
    env = robosuite.make(
        "Lift",
        robots="Panda",
        controller_configs=config,
        has_renderer=False,
        has_offscreen_renderer=False,
        use_camera_obs=False,
        ignore_done=True,
        control_freq=20,
    )
    env.reset()
    action = np.zeros(env.action_spec[0].shape)
    substeps = round(env.control_timestep / env.model_timestep)
    model, data = env.sim.model._model, env.sim.data._data  # noqa: SLF001 - no other way
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
        "robot": f"robosuite {robosuite.__version__}, Panda",
        "controller": controller,
        "mode": f"MuJoCo {mujoco.__version__}",
        "temperature": "hot",
        **turns.row(),
    }


if __name__ == "__main__":
    ask_for_processor()
    json.dump([measure(controller) for controller in CONTROLLERS], sys.stdout)
