"""The options of the verbs of experiments."""

import pytest

from station.cli.arguments import build_parser


def test_ranges_and_options_of_a_sweep():
    options = build_parser().parse_args([
        *("sweep", "arm", "load=0:3", "delay=0,1", "--trials", "5"),
        *("--with", "friction=1", "--cluster", "tcp://here:8786"),
    ])

    assert (options.controller, options.ranges) == ("arm", ["load=0:3", "delay=0,1"])
    assert (options.trials, options.cluster) == (5, "tcp://here:8786")
    assert options.handler.endswith("experiments:sweep")


@pytest.mark.parametrize(
    "words",
    [["sweep", "arm"], ["tune"], ["experiments", "bake"], ["validate"], ["identify"]],
)
def test_missing_and_unknown_words_are_refused(words, capsys):
    with pytest.raises(SystemExit):
        build_parser().parse_args(words)
    assert capsys.readouterr().err
