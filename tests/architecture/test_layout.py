"""Every file is where a reader looks for it, says what it is, and stays readable.

Each check lists everything it finds, so that one run shows all that is to be done and
the number of tests says how much of the station is tested.
"""

import ast
import io
import re
import tokenize
from collections.abc import Callable
from pathlib import Path

from tests.for_each import for_each

ROOT = Path(__file__).parents[2]
MODULES = sorted((ROOT / "station").rglob("*.py"))
TESTS = sorted((ROOT / "tests").rglob("*.py"))

# A module is as long as its idea, and nothing is cut in two for this limit. Docstrings
# and comments do not count: a limit that counts them deletes documentation.
MAX_CODE_LINES = 450
GRAB_BAGS = {"common", "helper", "helpers", "misc", "stuff", "util", "utils"}
DOCUMENTED = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
# A first line is a noun, or a verb with an object that is a noun. A question in the
# place of the noun makes the reader find it.
QUESTIONS = "How|What|When|Where|Whether|Which|Who|Whoever|Whom|Whose|Why|With what"
HEADLESS = re.compile(rf"({QUESTIONS})\b")
QUESTIONING = re.compile(
    r"(Return|Say|Tell|Yield) (how|what|when|where|which|who|whom|whose|why)\b"
)
LIKELY_HEADLESS = re.compile(rf'"""\s*({HEADLESS.pattern}|{QUESTIONING.pattern})')
NOT_CODE = {
    tokenize.COMMENT,
    tokenize.DEDENT,
    tokenize.ENCODING,
    tokenize.ENDMARKER,
    tokenize.INDENT,
    tokenize.NEWLINE,
    tokenize.NL,
}


def relative(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def finds(check: Callable[[Path], str | None], paths: list[Path]) -> list[str]:
    """Return a line for every file in which the check finds something."""
    found = ((path, check(path)) for path in paths)
    return [f"{relative(path)}: {problem}" for path, problem in found if problem]


def docstring_lines(tree: ast.Module) -> set[int]:
    lines: set[int] = set()
    for node in ast.walk(tree):
        if isinstance(node, DOCUMENTED) and ast.get_docstring(node) is not None:
            first = node.body[0]
            lines.update(range(first.lineno, (first.end_lineno or first.lineno) + 1))
    return lines


def code_lines(text: str) -> int:
    """Count the lines that hold code: no docstrings, no comments, no blanks."""
    lines: set[int] = set()
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type not in NOT_CODE:
            lines.update(range(token.start[0], token.end[0] + 1))
    return len(lines - docstring_lines(ast.parse(text)))


def mirrored(folder: Path) -> bool:
    target = ROOT / "station" / folder
    return target.is_dir() or target.with_suffix(".py").exists()


def no_docstring(path: Path) -> str | None:
    begins = path.read_text().startswith('"""')
    return None if begins else "has no docstring in its first line"


def first_lines(text: str) -> list[tuple[str, str]]:
    """Return name and first line of every docstring."""
    nodes = [n for n in ast.walk(ast.parse(text)) if isinstance(n, DOCUMENTED)]
    described = [(getattr(n, "name", "module"), ast.get_docstring(n)) for n in nodes]
    return [(name, lines.split("\n")[0]) for name, lines in described if lines]


def headless(text: str) -> list[str]:
    if not LIKELY_HEADLESS.search(text):
        return []  # taking a module apart takes a hundred times as long
    return [
        f"{name}: {line}"
        for name, line in first_lines(text)
        if HEADLESS.match(line) or QUESTIONING.match(line)
    ]


def too_long(path: Path) -> str | None:
    text = path.read_text()
    # Most files are short enough with their docstrings, or without blanks and comments:
    # taking a file apart takes a hundred times as long.
    if len(re.findall(r"^ *[^ #\n]", text, re.MULTILINE)) <= MAX_CODE_LINES:
        return None
    lines = code_lines(text)
    return f"has {lines} lines of code" if lines > MAX_CODE_LINES else None


def nameless(path: Path) -> str | None:
    names = {part.removeprefix("test_") for part in path.with_suffix("").parts[-3:]}
    return "is not named after its concept" if names & GRAB_BAGS else None


def test_code_lines_leave_out_docstrings_comments_and_blanks():
    documented = '"""Doc\n\nmore."""\n\n# why\n'
    text = documented + 'x = [\n    1,\n]  # here\n\ny = """two\nlines"""\n'

    assert code_lines(text) == 5


def test_every_module_says_what_it_is():
    assert finds(no_docstring, MODULES + TESTS) == []


@for_each(
    "line",
    [
        "What a trial does.",
        "Who holds control.",
        "With what a browser asks.",
        "Whether it runs.",
        "Return which gains would change.",
    ],
)
def test_a_question_is_no_first_line(line):
    assert headless(f'def one():\n    """{line}"""\n') == [f"one: {line}"]
    assert headless(f'class One:\n    """{line}"""\n') == [f"One: {line}"]
    assert headless(f'"""{line}"""\n') == [f"module: {line}"]


@for_each(
    "line", ["The script of a trial.", "Return whether it runs.", "Whole numbers."]
)
def test_a_noun_or_a_verb_is_a_first_line(line):
    assert headless(f'def one():\n    """{line}"""\n') == []


def test_no_docstring_begins_with_a_question():
    found = [
        f"{relative(path)}: {problem}"
        for path in MODULES
        for problem in headless(path.read_text())
    ]

    assert found == [], "begin with a noun, or with a verb and its object"


def test_every_module_is_short_enough_to_read():
    found = finds(too_long, MODULES + TESTS)

    assert found == [], f"reshape these; the limit is {MAX_CODE_LINES}"


def test_every_module_is_named_after_its_concept():
    assert finds(nameless, MODULES + TESTS) == []


def test_every_folder_of_tests_mirrors_a_folder_of_the_station():
    packages = {p.name for p in (ROOT / "station").iterdir() if p.is_dir()}
    folders = [
        folder
        for name in packages
        for folder in sorted((ROOT / "tests" / name).rglob("*"))
        if folder.is_dir() and folder.name != "__pycache__"
    ]

    orphans = [f for f in folders if not mirrored(f.relative_to(ROOT / "tests"))]
    assert [relative(folder) for folder in orphans] == []
