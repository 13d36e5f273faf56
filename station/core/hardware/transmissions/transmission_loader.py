"""Build transmissions from their descriptions.

Source: ros_control@633c374 transmission_loader.cpp, simple_transmission_loader.cpp,
differential_transmission_loader.cpp, four_bar_linkage_transmission_loader.cpp.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from importlib.metadata import entry_points
from typing import TypeVar

from station.core.description.urdf_text import element_text, parse_leading_number
from station.core.hardware.transmissions.parser import (
    ActuatorInfo,
    JointInfo,
    TransmissionInfo,
)
from station.core.hardware.transmissions.transmission import (
    DifferentialTransmission,
    FourBarLinkageTransmission,
    SimpleTransmission,
    Transmission,
    TransmissionInterfaceError,
)

_Member = TypeVar("_Member", JointInfo, ActuatorInfo)
TransmissionFactory = Callable[[TransmissionInfo], Transmission]


def load_simple_transmission(info: TransmissionInfo) -> SimpleTransmission:
    """Build a transmission from one actuator's reduction and one joint's offset.

    Args:
        info: The description of the transmission.

    Returns:
        The transmission.

    Raises:
        TransmissionInterfaceError: An element is missing or wrong, or there are too
            many joints or actuators.
    """
    _check_dimension(info, 1)
    reduction = _read_required(info, "Actuator", info.actuators[0])
    offset = _read_number(info, "Joint", info.joints[0], "offset", 0.0)
    with _naming(info):
        return SimpleTransmission(reduction, offset)


def load_differential_transmission(info: TransmissionInfo) -> DifferentialTransmission:
    """Build a differential transmission from reductions and offsets by role.

    Args:
        info: The description of the transmission.

    Returns:
        The transmission.

    Raises:
        TransmissionInterfaceError: An element is missing or wrong, or there are too
            many joints or actuators.
    """
    reductions, joint_reductions, offsets = _read_two_by_two(info)
    ignored = [j.element.find("ignoreTransmissionAbsoluteEncoder") for j in info.joints]
    with _naming(info):
        return DifferentialTransmission(
            reductions,
            joint_reductions,
            offsets,
            ignore_transmission_for_absolute_encoders=None not in ignored,
        )


def load_four_bar_linkage_transmission(
    info: TransmissionInfo,
) -> FourBarLinkageTransmission:
    """Build a four-bar linkage transmission from reductions and offsets by role.

    Args:
        info: The description of the transmission.

    Returns:
        The transmission.

    Raises:
        TransmissionInterfaceError: An element is missing or wrong, or there are too
            many joints or actuators.
    """
    parameters = _read_two_by_two(info)
    with _naming(info):
        return FourBarLinkageTransmission(*parameters)


TRANSMISSION_TYPES: Mapping[str, TransmissionFactory] = {
    "transmission_interface/SimpleTransmission": load_simple_transmission,
    "transmission_interface/DifferentialTransmission": load_differential_transmission,
    "transmission_interface/FourBarLinkageTransmission": (
        load_four_bar_linkage_transmission
    ),
}
"""The types that every robot knows."""

ENTRY_POINT_GROUP = "station.transmissions"
"""Group of entry points through which installed packages add types. An entry's name is
the type; its object takes a `TransmissionInfo` and returns a `Transmission`."""


def load_transmission(
    info: TransmissionInfo, types: Mapping[str, TransmissionFactory] | None = None
) -> Transmission:
    """Build the transmission of a description.

    Args:
        info: The description of the transmission.
        types: Further types, tried before those of this module and of entry points.

    Returns:
        The transmission.

    Raises:
        TransmissionInterfaceError: The type is unknown, or the description is wrong.
    """
    known = {**TRANSMISSION_TYPES, **(types or {})}
    factory = known.get(info.type)
    # Own types first: a package cannot exchange a type of ros_control.
    if factory is None:
        for entry in entry_points(group=ENTRY_POINT_GROUP, name=info.type):
            factory = entry.load()
    if factory is None:
        raise TransmissionInterfaceError(
            f"Failed to load transmission '{info.name}'. "
            f"Unsupported type '{info.type}'.",
            remedy=f"Use one of {', '.join(sorted(known))}, or install a package with "
            f"an entry point '{info.type}' in the group '{ENTRY_POINT_GROUP}'.",
            details={"transmission": info.name},
        )
    return factory(info)


def _read_two_by_two(
    info: TransmissionInfo,
) -> tuple[list[float], list[float], list[float]]:
    """Return actuator reductions, joint reductions and joint offsets, by role."""
    _check_dimension(info, 2)
    actuators = _order_by_role(info, "actuator", info.actuators)
    reductions = [_read_required(info, "Actuator", a) for a in actuators]
    joints = _order_by_role(info, "joint", info.joints)
    joint_reductions, offsets = [], []
    for joint in joints:
        joint_reductions.append(
            _read_number(info, "Joint", joint, "mechanicalReduction", 1.0)
        )
        offsets.append(_read_number(info, "Joint", joint, "offset", 0.0))
    return reductions, joint_reductions, offsets


@contextmanager
def _naming(info: TransmissionInfo) -> Iterator[None]:
    # Errors of the constructor lack the name of the transmission.
    try:
        yield
    except TransmissionInterfaceError as exc:
        raise TransmissionInterfaceError(
            f"Failed to construct transmission '{info.name}' of type "
            f"'{info.type.replace('/', '::')}'. {exc.message}",
            remedy=exc.remedy,
            details={"transmission": info.name},
        ) from exc


def _check_dimension(info: TransmissionInfo, expected: int) -> None:
    for kind, count in (
        ("actuators", len(info.actuators)),
        ("joints", len(info.joints)),
    ):
        if count != expected:
            raise TransmissionInterfaceError(
                f"Invalid description for transmission '{info.name}' of type "
                f"'{info.type}'. Expected {expected} {kind}, got {count}.",
                remedy=f"Give the transmission {expected} {kind}.",
                details={"transmission": info.name},
            )


def _order_by_role(
    info: TransmissionInfo, kind: str, members: Sequence[_Member]
) -> list[_Member]:
    expected = [f"{kind}1", f"{kind}2"]
    roles = []
    for member in members:
        element = member.element.find("role")
        where = f"{kind.title()} '{member.name}' of transmission '{info.name}'"
        if element is None:
            raise _wrong(info, f"{where} does not specify the required <role> element.")
        role = element_text(element)
        if not role:
            raise _wrong(info, f"{where} specifies an empty <role> element.")
        if role not in expected:
            raise _wrong(
                info,
                f"{where} does not specify a valid <role> element. Got '{role}', "
                f"expected '{expected[0]}' or '{expected[1]}'.",
            )
        roles.append(role)
    if roles[0] == roles[1]:
        raise _wrong(
            info,
            f"{kind.title()}s '{members[0].name}' and '{members[1].name}' of "
            f"transmission '{info.name}' must have different roles. "
            f"Both specify '{roles[0]}'.",
        )
    ordered = list(members)
    return ordered if roles == expected else ordered[::-1]


def _read_required(info: TransmissionInfo, kind: str, member: _Member) -> float:
    return _read_number(info, kind, member, "mechanicalReduction", None)


def _read_number(
    info: TransmissionInfo,
    kind: str,
    member: _Member,
    tag: str,
    default: float | None,
) -> float:
    element = member.element.find(tag)
    where = f"{kind} '{member.name}' of transmission '{info.name}'"
    if element is None:
        if default is None:
            raise _wrong(
                info, f"{where} does not specify the required <{tag}> element."
            )
        return default
    number = parse_leading_number(element_text(element))
    if number is None:
        raise _wrong(
            info, f"{where} specifies the <{tag}> element, but is not a number."
        )
    return number


def _wrong(info: TransmissionInfo, message: str) -> TransmissionInterfaceError:
    return TransmissionInterfaceError(
        message,
        remedy=f'Correct the <transmission name="{info.name}"> element.',
        details={"transmission": info.name},
    )
