"""Verb `robot`: what its arguments mean."""

import pytest

from station.cli import main


@pytest.mark.parametrize("wrong", ["mass", "=1", "a b=1", "1x=2"])
def test_an_argument_without_name_or_value_is_wrong_usage(wrong, capsys):
    assert main(["robot", "panda", "set_load", wrong]) == 2
    assert f"{wrong!r} is not NAME=VALUE." in capsys.readouterr().err
