"""Verb `validate`: does a robot do what its description says?"""

from argparse import Namespace
from typing import TYPE_CHECKING

from station.cli.output import say_json, say_table
from station.experiments.validation import validate as check_robot
from station.trials.setup import Setup

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path


def validate(options: Namespace) -> int:
    """Check a robot and its controllers."""
    robot: Path = options.robot
    config: Path | Mapping[str, object] = robot
    if robot.suffix in {".urdf", ".xacro"}:
        config = {
            "robot": {
                "type": "mujoco_hw/MujocoRobotHW",
                "robot_description": str(robot.resolve()),
            }
        }
    card = check_robot(Setup.load(config, controllers=options.controllers), robot.name)
    if options.page is not None:
        options.page.write_text(card.to_html(), encoding="utf-8")
    if options.json:
        say_json([
            {"name": c.name, "outcome": c.outcome, "detail": c.detail}
            for c in card.checks
        ])
    else:
        rows = [[check.name, check.outcome, check.detail] for check in card.checks]
        say_table(["check", "outcome", "what was seen"], rows)
    return 0 if card.is_good else 1
