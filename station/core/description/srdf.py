"""Read from an SRDF which pairs of links must not be tested for contact."""

from pathlib import Path

from station.core.description.urdf_text import parse_robot
from station.core.errors import RobotDescriptionError


def disabled_collisions(srdf_path: Path | None) -> tuple[tuple[str, str], ...]:
    """Return the pairs of links of all `<disable_collisions>` elements.

    Args:
        srdf_path: The file, or None for a robot without an SRDF, which has no pairs.

    Raises:
        RobotDescriptionError: The file cannot be read, is not XML, or an element does
            not name two links.
    """
    if srdf_path is None:
        return ()
    try:
        root = parse_robot(srdf_path.read_text(encoding="utf-8"))
    except (OSError, RobotDescriptionError, UnicodeDecodeError) as exc:
        raise RobotDescriptionError(
            f"The SRDF {srdf_path} cannot be read: {exc}",
            remedy="Correct or remove that file.",
        ) from exc
    pairs = []
    for element in root.iter("disable_collisions"):
        first, second = element.get("link1"), element.get("link2")
        if not first or not second:
            raise RobotDescriptionError(
                f"{srdf_path}: A <disable_collisions> does not name link1 and link2.",
                remedy="Correct that element of the SRDF.",
            )
        pairs.append((first, second))
    return tuple(pairs)
