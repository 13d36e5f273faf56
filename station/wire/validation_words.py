"""Explain, in plain words, why a field of a request is refused."""

from collections.abc import Callable, Mapping
from typing import Any

Context = Mapping[str, Any]

_NOT_FINITE = ("NaN", "nan", "Infinity", "inf")
_WORDS: Mapping[str, str | Callable[[Context], str]] = {
    "missing": "is missing",
    "extra_forbidden": "is no field of this request",
    "float_type": "must be a number",
    "float_parsing": "must be a number",
    "int_type": "must be a whole number",
    "int_parsing": "must be a whole number",
    "int_from_float": "must be a whole number",
    "int_parsing_size": "is too large a number",
    "bool_type": "must be true or false",
    "bool_parsing": "must be true or false",
    "string_type": "must be text",
    "string_sub_type": "must be text",
    "string_unicode": "must be text that Unicode can write",
    "list_type": "must be a list",
    "dict_type": "must be an object",
    "model_type": "must be an object",
    "model_attributes_type": "must be an object",
    "none_required": "must be null",
    "finite_number": "must be a finite number",
    "json_type": "must be JSON",
    "invalid_key": "has a key that is no text",
    "recursion_loop": "is nested within itself",
    "too_short": lambda c: f"must have at least {_items(c, 'min_length')}",
    "too_long": lambda c: f"must have at most {_items(c, 'max_length')}",
    "string_too_short": lambda c: f"must have at least {_letters(c, 'min_length')}",
    "string_too_long": lambda c: f"must have at most {_letters(c, 'max_length')}",
    "string_pattern_mismatch": lambda c: _names(str(c.get("pattern"))),
    "greater_than": lambda c: f"must be greater than {c.get('gt')}",
    "greater_than_equal": lambda c: f"must be at least {c.get('ge')}",
    "less_than": lambda c: f"must be less than {c.get('lt')}",
    "less_than_equal": lambda c: f"must be at most {c.get('le')}",
    "literal_error": lambda c: f"must be {c.get('expected')}",
    "enum": lambda c: f"must be {c.get('expected')}",
    "union_tag_invalid": lambda c: (
        f"has the {_key(c)} '{c.get('tag')}'; allowed are {c.get('expected_tags')}"
    ),
    "union_tag_not_found": lambda c: f"has no {_key(c)}",
    "value_error": lambda c: str(c.get("error", "is not allowed")),
    "assertion_error": lambda c: str(c.get("error", "is not allowed")),
}


def explain(kind: str, context: Context) -> str:
    """Return an explanation of the error, which follows the name of the field.

    Args:
        kind: Name of the error in pydantic.
        context: Further facts from pydantic: limits, expected values.
    """
    words = _WORDS.get(kind, "is not what is allowed here")
    return words if isinstance(words, str) else words(context)


def explain_json(body: object, position: int, why: str) -> str:
    """Return the reason why a body is not valid JSON.

    Args:
        body: The body.
        position: Index of the character at which parsing failed.
        why: The parser's error message.
    """
    text = body.decode(errors="replace") if isinstance(body, bytes) else str(body)
    rest = text[position:].lstrip("-")
    for word in _NOT_FINITE:
        if rest.startswith(word):
            return (
                f"is no JSON at character {position}: JSON has no {word}; every number "
                "must be finite"
            )
    if "UTF-8" in why:  # the body has no text to show then
        return "is no JSON: it is no text in UTF-8"
    if not text.strip():
        return "is empty, where a JSON object is expected"
    shown = text[position : position + 20]
    at = f"{shown!r} at character {position}" if shown else "its end"
    return f"is no JSON: {why.partition(':')[0]}, at {at}"


def _names(pattern: str) -> str:
    """Return the words for a pattern of names; another pattern is given as it is."""
    signs = _SIGNS.get(pattern.replace("(", "").replace(")?", ""))
    if signs is None:
        return f"must match {pattern}"
    return f"must have letters {signs} alone, no sign but _ at first"


_SIGNS: Mapping[str, str] = {
    r"^[A-Za-z0-9_][A-Za-z0-9_.-]*$": "A to Z, digits and _ . -",
    r"^[A-Za-z0-9_][A-Za-z0-9_.@+-]*$": "A to Z, digits and _ . @ + -",
    r"^[\w][\w.@+ -]*$": "of any language, digits, spaces and _ . @ + -",
}
"""The signs of the names that each pattern allows."""


def _key(context: Context) -> str:
    return str(context.get("discriminator")).strip("'")


def _items(context: Context, key: str) -> str:
    return _counted(context.get(key), "item")


def _letters(context: Context, key: str) -> str:
    return _counted(context.get(key), "character")


def _counted(number: object, word: str) -> str:
    return f"{number} {word}" if number == 1 else f"{number} {word}s"
