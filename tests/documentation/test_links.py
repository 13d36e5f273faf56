"""Every link and every path that the documentation names leads somewhere."""

import re

from tests.documentation.shell_examples import PAGES, ROOT, blocks
from tests.for_each import for_each

_LINK = re.compile(r"\]\(([^)\s]+)\)")
_PATH = re.compile(
    r"`((?:benchmarks|docs|examples|station|tests|tools)/[\w./-]*)`|"
    r"\b(benchmarks/bench_\w+\.py)"
)


def anchors(text: str) -> set[str]:
    """Return what the headings of a page are linked by."""
    headings = re.findall(r"^#+ (.+)$", text, re.MULTILINE)
    plain = [re.sub(r"[^\w\s-]", "", heading.lower()) for heading in headings]
    return {heading.strip().replace(" ", "-") for heading in plain}


@for_each("page", PAGES, ids=lambda page: page.name)
def test_links_lead_to_files_and_headings(page):
    for target in _LINK.findall(page.read_text()):
        if target.startswith("https://"):
            continue
        path, _, anchor = target.partition("#")
        found = (page.parent / path).resolve() if path else page
        assert found.exists(), f"{page.name} links to {target}"
        assert not anchor or anchor in anchors(found.read_text()), target


@for_each("page", PAGES, ids=lambda page: page.name)
def test_paths_of_the_project_exist(page):
    for groups in _PATH.findall(page.read_text()):
        path = "".join(groups)
        assert (ROOT / path).exists(), f"{page.name} names {path}"


@for_each("page", PAGES, ids=lambda page: page.name)
def test_make_has_the_targets_that_are_named(page):
    targets = set(re.findall(r"^([a-z]+):", (ROOT / "Makefile").read_text(), re.M))
    text = page.read_text()
    inline = re.findall(r"`make ([a-z]+)", text)
    named = re.findall(r"^make ([a-z]+)", "\n".join(blocks(page)), re.M)

    assert set(inline + named) <= targets


@for_each("page", PAGES, ids=lambda page: page.name)
def test_every_block_is_closed(page):
    assert page.read_text().count("\n```") % 2 == 0
