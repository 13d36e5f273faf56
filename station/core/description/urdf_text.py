"""Read the XML of a robot description, and the text and numbers in it.

Source: TinyXML 2.6 as ros_control@633c374 uses it: namespaces are ignored, and an
element's text is the text before its first child, with runs of white space as one
blank.
"""

import re
from math import isinf
from xml.etree import ElementTree as ET

from station.core.errors import RobotDescriptionError

_DECIMAL = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?", re.ASCII)
_LEADING_NUMBER = re.compile(
    r"[+-]?(?:"
    r"(?P<hex>0x(?:[0-9a-f]+\.?[0-9a-f]*|\.[0-9a-f]+)(?:p[+-]?\d+)?)"
    r"|(?:\d+\.?\d*|\.\d+)(?:e[+-]?\d+)?|infinity|inf|nan)",
    re.ASCII | re.IGNORECASE,
)


def parse_robot_description(text: str) -> ET.Element:
    """Return the root element of a robot description.

    Args:
        text: The document, usually a URDF.

    Returns:
        The root; names without namespace, comments kept as nodes.

    Raises:
        RobotDescriptionError: The text is not XML; the message has line and reason.
    """
    parser = ET.XMLParser(target=ET.TreeBuilder(insert_comments=True))
    try:
        parser.feed(text)
        root: ET.Element = parser.close()
    except ET.ParseError as exc:
        raise RobotDescriptionError(
            f"The robot description is not XML: {exc}.",
            remedy="Give a URDF document; run xacro on it first if it is a template.",
        ) from exc
    for element in root.iter():
        if isinstance(element.tag, str) and element.tag.startswith("{"):
            element.tag = element.tag.rpartition("}")[2]
    return root


def parse_robot(text: str) -> ET.Element:
    """Return the `<robot>` element of a URDF.

    Args:
        text: The document.

    Raises:
        RobotDescriptionError: The text is not XML, or its root is another element.
    """
    root = parse_robot_description(text)
    if root.tag != "robot":
        raise RobotDescriptionError(
            f"The robot description is not a URDF: its root element is <{root.tag}>.",
            remedy="Give a URDF, whose root element is <robot>.",
        )
    return root


def element_text(element: ET.Element) -> str:
    """Return the text before an element's first child; empty if there is none."""
    return " ".join((element.text or "").split())


def parse_leading_number(text: str) -> float | None:
    """Return the number at the start of a text as C++'s `std::stod` reads it.

    Text after the number is ignored; hexadecimal numbers, inf and nan are numbers.

    Args:
        text: Any text without leading white space.

    Returns:
        The number, or None if there is none or it is too large or too small for a
        float.
    """
    match = _LEADING_NUMBER.match(text)
    if match is None:
        return None
    if match["hex"]:
        return float.fromhex(match[0])
    number = float(match[0])
    overflow = isinf(number) and "inf" not in match[0].lower()
    underflow = number == 0.0 and re.search(r"[1-9]", match[0].lower().split("e")[0])
    return None if overflow or underflow else number


def parse_decimal(text: str) -> float | None:
    """Return the number of a text that is one decimal number, as urdfdom reads it.

    Args:
        text: Any text; white space around the number is not part of it.

    Returns:
        The finite number, or None if the text is something else.
    """
    if _DECIMAL.fullmatch(text.strip()) is None:
        return None
    number = float(text)
    return None if isinf(number) else number
