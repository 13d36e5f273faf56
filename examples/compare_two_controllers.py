"""Which of two controllers tracks better under chance loads, friction and delays?"""

from station.experiments.designs import parse_range, points
from station.experiments.experiment import ROBUSTNESS_RANGES, sweep
from station.experiments.pools import make_pool
from station.experiments.trial_world import TrialWorld, default_script
from station.trials.analysis import compare
from station.trials.results import Results, file_of
from station.trials.trial import Setup, Trial

NAMES = ("effort_joint_trajectory_controller", "effort_group_position_controller")
TRIALS = 10


def main() -> None:
    """Run the same chances with both controllers, and compare the means."""
    setup = Setup.load()
    chances = points(
        [parse_range(text) for text in ROBUSTNESS_RANGES], "random", TRIALS
    )
    found = []
    with make_pool() as pool:
        for name in NAMES:
            with TrialWorld(setup) as world:
                base = Trial(setup, default_script(world, name))
            found.append(Results.create(file_of(f"compare-{name}"), "sweep", setup, {}))
            sweep(base, chances, found[-1], pool)
    for row in compare(*found):
        one, other = row.means
        print(f"{row.metric:15} {one:10.4g} {other:10.4g}   p = {row.p_value:.4f}")
    for results in found:
        results.close()


if __name__ == "__main__":
    main()
