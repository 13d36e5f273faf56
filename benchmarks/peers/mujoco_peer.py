"""A loop over MuJoCo's Python binding: seven PD controllers in NumPy, and a step.

Loads a model and a state that benchmarks/bench_peers.py has written, and imports
nothing of the station.
"""

import json
import sys

import mujoco
import numpy as np
from paired_timing import Effort, ask_for_processor, measure_cold, measure_hot

KIND = mujoco.mjtState.mjSTATE_INTEGRATION
STIFFNESS = np.array([600.0, 600.0, 600.0, 600.0, 250.0, 150.0, 50.0])
DAMPING = np.array([30.0, 30.0, 30.0, 30.0, 10.0, 10.0, 5.0])


def main(path: str, start: list[float]) -> list[dict[str, object]]:
    """Return the rows, hot and cold.

    Args:
        path: The compiled model of the Panda.
        start: Where all joints start.
    """
    model = mujoco.MjModel.from_binary_path(path)
    data, copy = mujoco.MjData(model), mujoco.MjData(model)
    state = np.zeros(mujoco.mj_stateSize(model, KIND))
    data.qpos[:] = start
    mujoco.mj_forward(model, data)
    target = data.qpos[:7].copy()
    target[0] = 0.3

    def begin() -> None:
        mujoco.mj_getState(model, data, state, KIND)
        mujoco.mj_setState(model, copy, state, KIND)

    def step(count: int) -> None:
        for _ in range(count):
            mujoco.mj_step(model, copy)

    def cycle(count: int) -> None:
        for _ in range(count):
            error = target - data.qpos[:7]
            data.qfrc_applied[:7] = STIFFNESS * error - DAMPING * data.qvel[:7]
            mujoco.mj_step(model, data)

    cycle(1000)
    return [
        {
            "robot": "MuJoCo's Python binding, Panda",
            "controller": "PD of seven joints in NumPy",
            "mode": f"MuJoCo {mujoco.__version__}",
            "temperature": temperature,
            **measure(step, cycle, begin, Effort()).row(),
        }
        for temperature, measure in (("hot", measure_hot), ("cold", measure_cold))
    ]


if __name__ == "__main__":
    ask_for_processor()
    json.dump(main(sys.argv[1], json.loads(sys.argv[2])), sys.stdout)
