"""Faults of code that the station did not write: what is contained, and in which words.

A controller or a robot may raise anything, and its text may be anything, too: an error
that cannot be printed, or letters that no JSON can carry.
"""

import traceback

MAX_REASON = 1000
"""Longest text of a fault: every client gets it, in every list of controllers."""
MAX_TRACE = 20_000
"""Longest traceback; its end is kept."""
CONTAINED = (Exception, SystemExit)
"""What a plugin may raise without harm to others; `exit()` in it ends nothing else."""


def reason_of(where: str, error: BaseException) -> str:
    """Return what happened in one line.

    Args:
        where: The callback that raised.
        error: What it raised.
    """
    return f"{where} raised {describe(error)}"


def describe(error: BaseException) -> str:
    """Return an exception as `Type: text`, in letters that every encoding has."""
    try:
        text = str(error)
    except CONTAINED:
        text = "(its text cannot be had)"
    if len(text) > MAX_REASON:
        text = f"{text[:MAX_REASON]}... ({len(text)} characters)"
    return printable(f"{type(error).__name__}: {text}")


def trace_of_fault() -> str:
    """Return the traceback of the exception being handled."""
    return printable(traceback.format_exc()[-MAX_TRACE:])


def printable(text: str) -> str:
    """Return `text` with escapes in place of lone surrogates, which no UTF-8 has."""
    return text.encode("utf-8", "backslashreplace").decode("utf-8")
