"""Let a storm loose: `python -m station.testing.storm --operations 100000`."""

import argparse
import sys

from station.testing.storm.storm import storm
from station.testing.storm.storm_robots import ROBOTS


def main(words: list[str] | None = None) -> int:
    """Let a storm loose and print its report; return 1 if something was wrong.

    Args:
        words: The words of the command line; None for those of this process.
    """
    parser = argparse.ArgumentParser(prog="python -m station.testing.storm")
    parser.add_argument("--operations", type=int, default=10_000)
    parser.add_argument("--threads", type=int, default=4)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--robot", choices=ROBOTS, default="mock")
    options = parser.parse_args(words)
    robot = ROBOTS[options.robot]
    report = storm(
        robot.create,
        operations=options.operations,
        threads=options.threads,
        seed=options.seed,
        faults=robot.faults,
        drift=robot.drift,
    )
    sys.stdout.write(f"{report}\n")
    return 0 if report.ok else 1


if __name__ == "__main__":
    sys.exit(main())
