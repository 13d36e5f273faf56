"""A cycle does not cost many times more steps of the simulation than it did."""

import json
import os
import subprocess
import sys

import pytest
import yaml

from station.compiled import SWITCH, find_misfit
from tests.system.station_process import ROOT

BOUNDS = yaml.safe_load((ROOT / "tests" / "data" / "cycle_ratios.yaml").read_text())


@pytest.mark.parametrize("mode", ["interpreted", "compiled"])
def test_ratio_of_cycle_and_step_stays_below_its_bound(mode):
    if mode == "compiled" and find_misfit() is not None:
        pytest.skip("nothing is compiled")
    options = ["--robots", "panda", "--temperature", "hot", "--quick", "--json"]
    result = subprocess.run(
        [sys.executable, "benchmarks/bench_cycle.py", "--mode", mode, *options],
        cwd=ROOT,
        env={k: v for k, v in os.environ.items() if k != SWITCH},
        capture_output=True,
        text=True,
        check=True,
    )
    rows = {row["controller"]: row for row in json.loads(result.stdout)}

    assert {row["mode"] for row in rows.values()} == {mode}
    measured = {name: rows[name]["ratio"] for name in BOUNDS[mode]}
    slow = {n: r for n, r in measured.items() if not 1.0 < r < BOUNDS[mode][n]}
    assert slow == {}
