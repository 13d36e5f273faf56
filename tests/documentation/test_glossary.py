"""The glossary explains the house words that public classes are named after."""

import re

from tests.documentation.shell_examples import ROOT

# Words that ros_control does not have, or not in this sense.
HOUSE_WORDS = set(
    re.findall(
        r"\w+",
        """
        alarm bench dock epoch gate ghost guard incident latch layer
        lease port ring sample scorecard seam slot snapshot storm tap
        tunable
        """,
    )
)


def explained(glossary: str) -> set[str]:
    return set(re.findall(r"^- \*\*(.+?)\*\*", glossary, re.MULTILINE))


def words_of(name: str) -> set[str]:
    """Return the words of a class name: `CycleTap` has `cycle` and `tap`."""
    return {word.lower() for word in re.findall(r"[A-Z]+(?![a-z])|[A-Z][a-z]*", name)}


def unexplained(names: set[str], glossary: str) -> dict[str, set[str]]:
    """Return the names with a house word that has no entry, by word."""
    missing = HOUSE_WORDS - explained(glossary)
    found = {w: {name for name in names if w in words_of(name)} for w in missing}
    return {word: names for word, names in found.items() if names}


def public_classes() -> set[str]:
    sources = (path.read_text() for path in (ROOT / "station").rglob("*.py"))
    found = (re.findall(r"^ *class ([A-Z]\w*)", text, re.M) for text in sources)
    return {name for names in found for name in names}


def test_a_house_word_without_an_entry_is_found():
    glossary = "- **port**: where set-points are left"

    found = unexplained({"CycleTap", "GoalPort", "Tapestry"}, glossary)

    assert found == {"tap": {"CycleTap"}}


def test_every_house_word_of_a_public_class_has_an_entry():
    glossary = (ROOT / "docs" / "glossary.md").read_text()

    assert unexplained(public_classes(), glossary) == {}


def test_every_house_word_that_no_class_is_named_after_has_an_entry_too():
    glossary = (ROOT / "docs" / "glossary.md").read_text()

    assert explained(glossary) >= HOUSE_WORDS
