"""Unknown words are answered with the nearest known ones."""

import pytest

from station.cli.parser import Parser


@pytest.fixture
def parser():
    parser = Parser(prog="station")
    verbs = parser.add_subparsers(metavar="VERB", dest="verb")
    for name in ("list_controllers", "load_controller", "gains", "goto", "run"):
        verbs.add_parser(name)
    return parser


def test_an_unknown_verb_gets_the_nearest(parser, capsys):
    with pytest.raises(SystemExit) as end:
        parser.parse_args(["list_controler"])

    assert end.value.code == 2
    assert "Did you mean 'list_controllers'?" in capsys.readouterr().err


def test_a_known_verb_is_taken(parser):
    assert parser.parse_args(["gains"]).verb == "gains"
