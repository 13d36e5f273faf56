"""Write which modules the page loads into station/ui/static/page.html.

A browser learns of a module when it has read the one that imports it, so that a page
of many modules is loaded level by level. It is told of all of them at once instead.

python tools/page_modules.py           writes the list
python tools/page_modules.py --check   fails when it is stale
"""

import posixpath
import re
import sys
from pathlib import Path

STATIC = Path(__file__).parents[1] / "station/ui/static"
PAGE = STATIC / "page.html"
FIRST = "workspace.js"
_IMPORT = re.compile(
    r"""(?:^|[;\n])\s*(?:import|export)\b[^"';()]*["'](\.[^"']+)["']"""
)
_LINE = re.compile(r' *<link rel="modulepreload" href="/static/[^"]+" />\n')
# After the script of the strip, which nothing may delay.
_SCRIPT = re.compile(r' *<script src="/static/workspace\.js"')


def modules() -> list[str]:
    """Return the modules below `STATIC` that the page loads, in the order they are met.

    Raises:
        FileNotFoundError: A module imports one that does not exist.
    """
    found = [FIRST]
    for name in found:
        folder = posixpath.dirname(name)
        for wanted in _IMPORT.findall((STATIC / name).read_text()):
            path = posixpath.normpath(posixpath.join(folder, wanted))
            if path not in found:
                found.append(path)
    return found[1:]


def text() -> str:
    """Return the page with the present list.

    Raises:
        SystemExit: The page does not load the first module.
    """
    page = _LINE.sub("", PAGE.read_text())
    before = _SCRIPT.search(page)
    if before is None:
        raise SystemExit(f"{PAGE} loads no /static/{FIRST}.")
    links = (
        f'    <link rel="modulepreload" href="/static/{m}" />\n' for m in modules()
    )
    return page[: before.start()] + "".join(links) + page[before.start() :]


def main() -> int:
    """Write the list, or with `--check` return 1 when it is stale."""
    if "--check" in sys.argv[1:]:
        if PAGE.read_text() != text():
            print("page.html is stale: run `python tools/page_modules.py`.")
            return 1
        return 0
    PAGE.write_text(text())
    return 0


if __name__ == "__main__":
    sys.exit(main())
