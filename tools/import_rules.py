"""The direction of imports in docs/architecture.md, from pyproject.toml's contracts.

python tools/import_rules.py           writes it
python tools/import_rules.py --check   fails when it is stale
"""

import sys
import tomllib
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "architecture.md"
BEGIN = "<!-- imports: written by `python tools/import_rules.py` -->\n"
END = "<!-- end of imports -->"


def page() -> str:
    """Return the text of the page with the rules as they are in pyproject.toml."""
    before, _, rest = PAGE.read_text().partition(BEGIN)
    return before + BEGIN + rules() + END + rest.partition(END)[2]


def rules() -> str:
    """Return the layers of the station and of core."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text())
    contracts = {c["id"]: c for c in settings["tool"]["importlinter"]["contracts"]}
    return (
        f"{_layers(contracts['layers'])}\n"
        "A line may import those below it. `|` separates siblings that do not know "
        "each other, `:` those that may.\nInside `core` the order is:\n\n"
        f"{_layers(contracts['core-layers'])}"
    )


def _layers(contract: dict[str, Any]) -> str:
    lines = (" ".join(line.split()) for line in contract["layers"])
    return "```\n" + "".join(f"{_plain(line)}\n" for line in lines) + "```\n"


def _plain(line: str) -> str:
    return line.replace("(", "").replace(")", "")


def main() -> int:
    """Write the page, or with `--check` say whether it is stale and return 1."""
    if "--check" not in sys.argv[1:]:
        PAGE.write_text(page())
    elif page() != PAGE.read_text():
        print(f"{PAGE.name} is stale; run `python tools/import_rules.py`.")
        return 1
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
