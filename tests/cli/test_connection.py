"""Verbs talk to the station that the options name."""

from argparse import Namespace

import pytest

from station.cli.connection import locate, open_client
from station.cli.errors import UsageError


def test_client_talks_to_the_station():
    with open_client(Namespace(url="http://robot:8000/", token="t", ca=None)) as client:
        assert client.url == "http://robot:8000"


def test_wrong_url_is_wrong_usage():
    with pytest.raises(UsageError, match="'robot' is not the URL of a station"):
        locate("robot", None)
