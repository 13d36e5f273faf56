"""The log as JSON."""

import json
import logging
import sys

import pytest

from station.cli.verbs.run import JsonFormatter, set_up_log

pytestmark = pytest.mark.usefixtures("log_as_before")


@pytest.fixture
def log():
    """Return a logger."""
    return logging.getLogger("station.test")


def read(text):
    return [json.loads(line) for line in text.splitlines()]


def test_each_record_is_an_object_of_its_own(log, capsys):
    set_up_log("json")
    log.info("a %s\nb", "value")
    log.warning("careful")

    first, second = read(capsys.readouterr().err)

    assert first["message"] == "a value\nb"
    assert (first["level"], first["logger"]) == ("info", "station.test")
    assert first["time"].endswith("+00:00")
    assert second["level"] == "warning"
    assert "request_id" not in first


def test_the_traceback_goes_with_its_record(log, capsys):
    set_up_log("json")
    try:
        _ = 1 / 0
    except ZeroDivisionError:
        log.exception("it failed")

    (line,) = read(capsys.readouterr().err)
    assert "ZeroDivisionError" in line["exception"]


def test_the_name_of_the_request_goes_with_its_record():
    record = logging.LogRecord("a", logging.INFO, "", 0, "m", (), None)
    record.request_id = "abc"

    assert json.loads(JsonFormatter().format(record))["request_id"] == "abc"


def test_for_people_only_warnings_are_written(log, capsys):
    set_up_log("text")
    log.info("quiet")
    log.warning("loud")

    assert capsys.readouterr().err == "WARNING: loud\n"
    assert sys.stderr
