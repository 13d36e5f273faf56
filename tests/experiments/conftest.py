"""The setups, scripts, worlds and results of the trials' own tests."""

from tests.trials.conftest import GROUP, fill, panda, results, step, world

__all__ = ["GROUP", "fill", "panda", "results", "step", "world"]
