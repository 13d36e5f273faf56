"""Arguments that name a robot."""

from station.cli.arguments import build_parser


def test_run_takes_a_robot_and_its_base() -> None:
    options = build_parser().parse_args([
        "run",
        "--robot",
        "r.urdf",
        "--base",
        "planar",
    ])
    assert (options.robot, options.base) == ("r.urdf", "planar")
    assert options.config is None


def test_doctor_looks_at_a_robot_if_there_is_one() -> None:
    assert build_parser().parse_args(["doctor"]).robot is None
    assert build_parser().parse_args(["doctor", "r.urdf"]).robot == "r.urdf"
