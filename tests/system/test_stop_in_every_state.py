"""A stop takes effect within three cycles, whatever the station is doing."""

import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
MOST_CYCLES = 3
STATES = {
    "idle",
    "moving",
    "paused",
    "real-time factor 0.01",
    "real-time factor 100",
    "loading a controller that hangs",
    "switching",
    "resetting",
    "recovering",
}


def test_a_stop_takes_effect_within_three_cycles_in_every_state():
    script = ROOT / "benchmarks" / "bench_stop.py"
    told = subprocess.run(
        [sys.executable, script, "--repeats", "2"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
        timeout=120.0,
    ).stdout

    cycles = {}
    for line in told.splitlines():
        state = next((s for s in STATES if line.startswith(f"{s}  ")), None)
        if state is not None:
            cycles[state] = int(line.removeprefix(state).split()[1])

    assert set(cycles) == STATES, told
    assert max(cycles.values()) <= MOST_CYCLES, told
