"""The shell examples of the documentation: found, and read as requests and verbs."""

import re
import shlex
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).parents[2]
PAGES = sorted([
    ROOT / "README.md",
    ROOT / "CHANGELOG.md",
    *(ROOT / "docs").rglob("*.md"),
])

EVERY_ROUTE = ROOT / "examples" / "every_route.sh"

_BLOCK = re.compile(r"^```sh\n(.*?)^```", re.DOTALL | re.MULTILINE)
_ASSIGNMENT = re.compile(r"([A-Z]+)=(.*)")
_STATUS = re.compile(r"\s#\s*(\d{3})\b")


@dataclass
class Command:
    """One command of an example.

    Attributes:
        text: As it is written.
        words: As a shell would split it, without the comment.
        status: The HTTP status that the comment tells; 0 when it tells none.
    """

    text: str
    words: list[str]
    status: int


@dataclass
class Request:
    """What a curl command asks for."""

    method: str = ""
    url: str = ""
    headers: dict[str, str] = field(default_factory=dict)
    body: str | None = None
    output: str = ""


def blocks(page: Path) -> list[str]:
    """Return the shell blocks of a page; a script is one block."""
    text = page.read_text()
    return [text] if page.suffix == ".sh" else _BLOCK.findall(text)


def commands(page: Path, variables: dict[str, str] | None = None) -> Iterator[Command]:
    """Yield the commands of a page's shell blocks, with `$NAME` replaced.

    Assignments are not commands. `variables` keep their values, whatever a page
    assigns; whoever runs the commands may add to them between two.
    """
    known = {} if variables is None else variables
    for block in blocks(page):
        for line in _logical_lines(block):
            assigned = _ASSIGNMENT.fullmatch(line)
            if assigned is None:
                yield _command(line, known)
            elif assigned[1] not in known:
                known[assigned[1]] = _command(assigned[2], known).words[0]


def _logical_lines(block: str) -> list[str]:
    """Return the lines of a block, those joined that a quote or backslash joins."""
    lines: list[str] = []
    pending = ""
    for line in block.replace("\\\n", " ").splitlines():
        pending = f"{pending}\n{line}" if pending else line
        if pending.replace("\\'", "").count("'") % 2 == 0:
            lines.append(pending)
            pending = ""
    assert not pending, f"a quote is not closed: {pending}"
    return [line for line in lines if line.strip() and not line.startswith("#")]


def _command(text: str, variables: dict[str, str]) -> Command:
    status = _STATUS.search(text)
    expanded = re.sub(r"\$(\w+)", lambda m: variables.get(m[1], m[0]), text)
    words = shlex.split(expanded, comments=True)
    return Command(text, words, int(status[1]) if status else 0)


def curl_request(words: list[str]) -> Request:
    """Return the request of a curl command; refuse options that are not known here."""
    request = Request()
    rest = iter(words[1:])
    for word in rest:
        if word in {"-X", "--request"}:
            request.method = next(rest)
        elif word in {"-H", "--header"}:
            name, _, value = next(rest).partition(":")
            request.headers[name.strip()] = value.strip()
        elif word in {"-d", "--data", "--data-binary"}:
            request.body = next(rest)
        elif word in {"-o", "--output"}:
            request.output = next(rest)
        elif word in {"-s", "-i"}:
            continue
        else:
            assert not word.startswith("-"), f"unknown option {word} of curl"
            request.url = word
    request.method = request.method or ("GET" if request.body is None else "POST")
    return request
