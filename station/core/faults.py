"""Describe exceptions raised by controllers and robots that users wrote.

Such an exception may be of any type. Its text may fail to print, be of any length, or
contain surrogates that no JSON can carry.
"""

import traceback

MAX_REASON = 1000
"""Longest text of a fault [characters]; every list of controllers contains it."""
MAX_TRACE = 20_000
"""Longest traceback [characters]; a longer one loses its beginning."""
CONTAINED = (Exception, SystemExit)
"""Exceptions that end only the plugin that raised them; `exit()` raises the second."""


def reason_of(where: str, error: BaseException) -> str:
    """Return one line that names a callback and the exception it raised.

    Args:
        where: Name of the callback.
        error: The exception.
    """
    return f"{where} raised {describe(error)}"


def describe(error: BaseException) -> str:
    """Return an exception as `Type: text`, without lone surrogates."""
    try:
        text = str(error)
    except CONTAINED:
        text = "(its text cannot be read)"
    if len(text) > MAX_REASON:
        text = f"{text[:MAX_REASON]}... ({len(text)} characters)"
    return printable(f"{type(error).__name__}: {text}")


def trace_of_fault() -> str:
    """Return the traceback of the exception that is being handled."""
    return printable(traceback.format_exc()[-MAX_TRACE:])


def printable(text: str) -> str:
    """Return `text` with lone surrogates, which UTF-8 cannot encode, as escapes."""
    return text.encode("utf-8", "backslashreplace").decode("utf-8")
