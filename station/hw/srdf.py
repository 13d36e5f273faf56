"""Read from an SRDF which pairs of links are never tested for contact."""

from pathlib import Path
from xml.etree import ElementTree

from station.core.errors import RobotDescriptionError


def disabled_collisions(srdf_path: Path | None) -> tuple[tuple[str, str], ...]:
    """Return the pairs of links of all `<disable_collisions>` elements.

    Args:
        srdf_path: The file, or None for a robot without one: no pairs.

    Raises:
        RobotDescriptionError: The file cannot be read, is not XML, or an element does
            not name two links.
    """
    if srdf_path is None:
        return ()
    try:
        root = ElementTree.fromstring(srdf_path.read_text(encoding="utf-8"))
    except (OSError, ElementTree.ParseError, UnicodeDecodeError) as exc:
        raise RobotDescriptionError(
            f"cannot read the SRDF {srdf_path}: {exc}",
            remedy="correct or remove that file",
        ) from exc
    pairs = []
    for element in root.iter("disable_collisions"):
        first, second = element.get("link1"), element.get("link2")
        if not first or not second:
            raise RobotDescriptionError(
                f"{srdf_path}: a <disable_collisions> does not name link1 and link2",
                remedy="correct that element of the SRDF",
            )
        pairs.append((first, second))
    return tuple(pairs)
