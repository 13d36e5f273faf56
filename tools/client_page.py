"""The reference in docs/client.md, from the docstrings of the client.

python tools/client_page.py           writes it
python tools/client_page.py --check   fails when it is stale
"""

import inspect
import re
import sys
from pathlib import Path

from station import client

PAGE = Path(__file__).parents[1] / "docs" / "client.md"
BEGIN = "<!-- Below: written by `make client` from the docstrings. -->\n"
NOWHERE = client.StationClient("http://nowhere", "token")
# The parts of a client, such as `client.recordings`, in the order in which it has them.
PARTS = tuple(
    type(part) for name, part in vars(NOWHERE).items() if not name.startswith("_")
)
NOWHERE.close()
CLASSES = (
    client.StationClient,
    client.RobotClient,
    client.GripperClient,
    *PARTS,
    client.GoalHandle,
    client.Stream,
    client.Samples,
    client.Pose,
)


def page() -> str:
    """Return the text of the page: what is written by hand, and the reference."""
    by_hand, _, _ = PAGE.read_text().partition(BEGIN)
    return by_hand + BEGIN + "\n" + "".join(_section(kind) for kind in CLASSES)


def _section(kind: type) -> str:
    return f"- **{kind.__name__}**: {_first_line(kind)}\n"


def _first_line(member: object) -> str:
    paragraph = (inspect.getdoc(member) or "").partition("\n\n")[0]
    return re.sub(r"\s+", " ", paragraph)


def main() -> int:
    """Write the page, or with `--check` say whether it is stale and return 1."""
    if "--check" not in sys.argv[1:]:
        PAGE.write_text(page())
    elif page() != PAGE.read_text():
        print(f"{PAGE.name} is stale; run `make client`.")
        return 1
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
