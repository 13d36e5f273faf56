"""Options of the verb for grippers."""

from station.cli.arguments import build_parser


def test_options_have_the_defaults_of_the_api():
    options = build_parser().parse_args(["gripper", "move", "0.08"])

    assert (options.words, options.speed) == (["move", "0.08"], 0.1)
    assert (options.inner, options.outer) == (0.005, 0.005)
    assert not options.no_wait
