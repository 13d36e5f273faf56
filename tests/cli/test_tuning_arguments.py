"""Words of the verbs for gains and parameters."""

import pytest

from station.cli.arguments import build_parser


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("gains save stiff arm leg", ["arm", "leg"]),
        ("gains set arm j1/p=5", ["j1/p=5"]),
        ("gains list", []),
    ],
)
def test_gains_takes_a_name_and_words(line, words):
    assert build_parser().parse_args(line.split()).words == words


def test_an_unknown_action_gets_the_nearest(capsys):
    with pytest.raises(SystemExit):
        build_parser().parse_args(["gains", "sav", "x"])
    assert "Did you mean 'save'?" in capsys.readouterr().err
