"""Lines of pages fit beside a terminal, so that a diff shows which sentence changed."""

from tests.documentation.shell_examples import ROOT

DOCS = sorted((ROOT / "docs").rglob("*.md"))
MOST = 160  # characters, in tables and blocks of code, too


def long_lines(text: str) -> list[str]:
    """Return number, length and beginning of each line that is too long."""
    return [
        f"{number}: {len(line)} characters: {line[:40]}"
        for number, line in enumerate(text.splitlines(), 1)
        if len(line) > MOST
    ]


def test_a_long_line_is_found_also_in_a_block_of_code():
    text = f"short\n```\n{'x' * (MOST + 1)}\n```\n{'y' * MOST}\n"

    assert long_lines(text) == [f"3: {MOST + 1} characters: {'x' * 40}"]


def test_no_page_has_a_long_line():
    found = [
        f"{page.relative_to(ROOT)}:{line}"
        for page in [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *DOCS]
        for line in long_lines(page.read_text())
    ]

    assert found == []
