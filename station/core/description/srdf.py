"""Read an SRDF: the pairs of links that may touch, and the named poses."""

from math import isfinite
from pathlib import Path
from xml.etree.ElementTree import Element

from station.core.description.urdf_text import parse_robot
from station.core.errors import RobotDescriptionError


def disabled_collisions(srdf_path: Path | None) -> tuple[tuple[str, str], ...]:
    """Return the pairs of links of all `<disable_collisions>` elements.

    Args:
        srdf_path: The file, or None for a robot without an SRDF, which has no pairs.

    Raises:
        RobotDescriptionError: The file cannot be read or is not XML, or an element
            does not name two links.
    """
    root = _read(srdf_path)
    if root is None:
        return ()
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


def group_states(srdf_path: Path | None) -> dict[str, dict[str, float]]:
    """Return the poses of all `<group_state>` elements: positions by joint [rad or m].

    Poses of the same name, for different groups of joints, are merged. Joints with
    several degrees of freedom are left out.

    Args:
        srdf_path: The file, or None for a robot without an SRDF, which has no poses.

    Raises:
        RobotDescriptionError: The file cannot be read or is not XML, or a position
            is not a finite number.
    """
    root = _read(srdf_path)
    states: dict[str, dict[str, float]] = {}
    for element in () if root is None else root.iter("group_state"):
        state = states.setdefault(element.get("name", ""), {})
        for joint in element.iter("joint"):
            name, text = joint.get("name", ""), joint.get("value", "")
            if len(text.split()) > 1:
                continue  # a joint with several degrees of freedom, such as a base's
            try:
                value = float(text)
            except ValueError:
                value = float("nan")
            if not (name and isfinite(value)):
                raise RobotDescriptionError(
                    f"{srdf_path}: Joint '{name}' of a <group_state> has the position "
                    f"'{text}', which is no finite number.",
                    remedy="Correct that element of the SRDF.",
                )
            state[name] = value
    return {name: state for name, state in states.items() if name and state}


def _read(srdf_path: Path | None) -> Element | None:
    """Return the root of an SRDF; None without a file.

    Raises:
        RobotDescriptionError: The file cannot be read or is not XML.
    """
    if srdf_path is None:
        return None
    try:
        return parse_robot(srdf_path.read_text(encoding="utf-8"))
    except (OSError, RobotDescriptionError, UnicodeDecodeError) as exc:
        raise RobotDescriptionError(
            f"The SRDF {srdf_path} cannot be read: {exc}",
            remedy="Correct or remove that file.",
        ) from exc
