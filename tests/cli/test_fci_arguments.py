"""The options of `station fci`."""

import pytest

from station.cli.arguments import build_parser


def test_it_listens_to_this_machine_alone_and_waits_for_nobody_unless_told():
    options = build_parser().parse_args(["fci"])
    assert (options.host, options.patience, options.config) == ("127.0.0.1", 0.0, None)
    options = build_parser().parse_args(["fci", "--patience", "0.25"])
    assert options.patience == 0.25


@pytest.mark.parametrize("wrong", ["-1", "10.1", "nan", "soon"])
def test_impossible_patience_is_refused(wrong, capsys):
    with pytest.raises(SystemExit) as end:
        build_parser().parse_args(["fci", f"--patience={wrong}"])
    assert end.value.code == 2
    assert "0 to 10" in capsys.readouterr().err
