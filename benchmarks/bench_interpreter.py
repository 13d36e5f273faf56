"""What holds the control thread up inside its own process.

Run `python benchmarks/bench_interpreter.py`. Three things are measured: MuJoCo's step
called so that it releases the interpreter lock and so that it keeps it, with a busy
thread beside it; one C call that keeps the lock; a garbage collection, with and without
the objects that live for ever frozen.
"""

import gc
import json
import statistics
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from time import perf_counter, sleep

import mujoco
import numpy as np
from measuring import REPEATS, print_table, print_title, simulated_world

from station.app.composition import compose
from station.config import load_config
from station.core.scheduling import SWITCH_INTERVAL
from station.hw.mujoco.world import direct_function

CALLS = 400
PAUSE = 0.001
"""Between two calls, as in a control loop [s]."""
PAYLOAD_ITEMS = 160_000
OBJECTS = 300_000


@contextmanager
def busy_thread() -> Iterator[None]:
    """Let another thread compute in Python."""
    ended = False

    def work() -> None:
        number = 0
        while not ended:
            number = (number * 31 + 7) % 1_000_003

    thread = threading.Thread(target=work, name="busy")
    thread.start()
    try:
        yield
    finally:
        ended = True
        thread.join()


def call_times(action: Callable[[], object]) -> tuple[float, float]:
    """Return median and 99th percentile of the time of a call [us]."""
    times = []
    for _ in range(CALLS):
        sleep(PAUSE)
        begin = perf_counter()
        action()
        times.append((perf_counter() - begin) * 1e6)
    p50, p99 = np.percentile(times, (50.0, 99.0))
    return float(p50), float(p99)


def step_rows() -> list[list[object]]:
    """Measure both ways to step, beside a busy thread."""
    world = simulated_world(compose(load_config()).station)
    model, data = world.model, world.data
    ways: list[tuple[str, Callable[[], object]]] = [
        ("mj_step, lock released", partial(mujoco.mj_step, model, data)),
        ("mj_step, lock kept", direct_function("mj_step", model, data)),
    ]
    usual = sys.getswitchinterval()
    rows: list[list[object]] = []
    for name, step in ways:
        rows.append([f"{name}, alone", *call_times(step)])
        for interval in (usual, SWITCH_INTERVAL):
            sys.setswitchinterval(interval)
            with busy_thread():
                times = call_times(step)
            sys.setswitchinterval(usual)
            rows.append([f"{name}, switch interval {interval * 1e3:g} ms", *times])
    return rows


def once_rows() -> list[list[object]]:
    """Measure what stops everybody for a while, medians of repeats."""
    payload = json.dumps([0.123456789012345] * PAYLOAD_ITEMS)
    kept = [[index] for index in range(OBJECTS)]
    rows: list[list[object]] = []
    size = len(payload) / 1e6
    actions: list[tuple[str, Callable[[], object]]] = [
        (f"json.loads of {size:.1f} MB", partial(json.loads, payload)),
        (f"gc.collect, {OBJECTS} lists alive", gc.collect),
    ]
    for name, action in actions:
        rows.append([name, *_repeat(action)])
    gc.freeze()
    rows.append([f"gc.collect, {len(kept)} lists frozen", *_repeat(gc.collect)])
    gc.unfreeze()
    return rows


def _repeat(action: Callable[[], object]) -> tuple[float, float]:
    times = []
    for _ in range(REPEATS):
        begin = perf_counter()
        action()
        times.append((perf_counter() - begin) * 1e6)
    return statistics.median(times), max(times)


def main() -> None:
    """Print the tables."""
    print_title(f"One step of the Panda beside a busy thread [us], {CALLS} calls")
    print_table(("call", "p50", "p99"), step_rows())
    print_title(f"One call that lets no other thread run [us], {REPEATS} calls")
    print_table(("call", "median", "max"), once_rows())


if __name__ == "__main__":
    main()
