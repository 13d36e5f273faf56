"""Whatever a plugin raises can be told."""

import json

from station.core.errors import describe, printable, reason_of, trace_of_fault


class Unprintable(Exception):  # noqa: N818 - a plugin's own
    """Raises when it is to say what it is."""

    def __str__(self) -> str:
        raise RuntimeError("no words")


def test_a_reason_names_callback_type_and_text():
    assert reason_of("update", ValueError("no")) == "update raised ValueError: no"


def test_an_error_without_words_is_still_named():
    assert describe(Unprintable()) == "Unprintable: (its text cannot be read)"


def test_text_that_no_encoding_has_is_escaped():
    assert describe(OSError("file \udc80")) == "OSError: file \\udc80"
    assert json.dumps(printable("ü 漢 \ud800"), ensure_ascii=False).encode()


def test_a_traceback_can_be_encoded_and_says_where():
    try:
        raise ValueError("\udcff")
    except ValueError:
        trace = trace_of_fault()
    assert "test_faults.py" in trace
    assert trace.encode()


def test_endless_text_is_cut():
    assert len(describe(ValueError("x" * 10_000_000))) < 2000
    try:
        raise ValueError("x" * 10_000_000)
    except ValueError:
        assert len(trace_of_fault()) <= 20_000
