"""The ranges in which services accept loads and pushes."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import hypot, isfinite

from station.core.errors import InvalidCommandError

LOAD_DISTANCE = 1.0
"""Largest coordinate of a load's centre of mass in the flange frame [m]; the reach of
the arm is 0.855 m."""
JOINT_STIFFNESS = (0.0, 14250.0)
"""Range of the joint impedance [Nm/rad]."""
TRANSLATIONAL_STIFFNESS = (10.0, 3000.0)
"""Range of the Cartesian impedance along the axes [N/m]."""
ROTATIONAL_STIFFNESS = (1.0, 300.0)
"""Range of the Cartesian impedance about the axes [Nm/rad]."""
PUSH_DISTANCE = 10.0
"""Largest distance of a push's point of application from the link's origin [m]."""


@dataclass(frozen=True, slots=True)
class ServiceLimits:
    """The largest values that services accept; the configuration may change them.

    Attributes:
        load_mass: Mass of a load [kg], > 0. Source: datasheets of Panda and Franka
            Research 3, payload 3 kg.
        push_force: Largest force of a push or of a simulated collision [N], > 0; by
            default more than the motors can hold at any distance above 0.2 m.
        push_torque: Largest torque of a push [Nm], > 0; by default more than the 87 Nm
            of the strongest motors.
        push_duration: Duration of a push [s], > 0.
    """

    load_mass: float = 3.0
    push_force: float = 500.0
    push_torque: float = 100.0
    push_duration: float = 3600.0


def check_vector(
    values: Sequence[float], largest: float, *, field: str, what: str, unit: str
) -> None:
    """Refuse a vector that is longer than a limit.

    Args:
        values: The vector, in `unit`, shape (3,).
        largest: Largest length of the vector, in `unit`.
        field: Name of the field of the request.
        what: The vector as a message names it, e.g. `force of a push`.
        unit: Unit of the vector.

    Raises:
        InvalidCommandError: The vector has not 3 finite numbers, or is too long.
    """
    # `not … <=`, so that a NaN length is refused, too.
    if len(values) != 3 or not hypot(*values) <= largest:
        raise InvalidCommandError(
            f"The {what} is {list(values)} {unit}; allowed are 3 numbers, and a length "
            f"of at most {largest:g} {unit}.",
            remedy="Choose a smaller vector, or raise the limit in the robot's "
            "parameter service_limits.",
            details=field_error(
                field, f"must have a length of at most {largest:g} {unit}", list(values)
            ),
        )


def check_ranges(
    values: Sequence[float], ranges: Sequence[tuple[float, float]], what: str
) -> list[float]:
    """Return numbers of a request as a list if each is in its range.

    Args:
        values: The numbers.
        ranges: Lowest and highest value of each number.
        what: Name of the field.

    Raises:
        InvalidCommandError: A number is out of its range, or the count is wrong.
    """
    found = [
        field_error(f"{what}/{i}", f"must be {low:g} to {high:g}", value)["errors"][0]
        for i, (value, (low, high)) in enumerate(zip(values, ranges, strict=False))
        if not low <= value <= high
    ]
    if len(values) != len(ranges) or found:
        allowed = ", ".join(f"{low:g} to {high:g}" for low, high in ranges)
        raise InvalidCommandError(
            f"'{what}' is {list(values)}; allowed are {allowed}.",
            remedy=f"Give {len(ranges)} numbers in these ranges.",
            details={"errors": found},
        )
    return list(values)


def check_load(
    mass: float,
    center: Sequence[float],
    inertia: Sequence[float],
    limits: ServiceLimits,
) -> None:
    """Refuse a load outside the range that the arm can carry.

    Args:
        mass: Mass [kg].
        center: Centre of mass in the flange frame [m], shape (3,).
        inertia: Inertia about the centre of mass [kg m^2], 9 numbers.
        limits: The limits.

    Raises:
        InvalidCommandError: A number is not finite or out of range.
    """
    largest = limits.load_mass
    if not 0.0 <= mass <= largest:
        raise InvalidCommandError(
            f"A load of {mass} kg is not possible; allowed are 0 to {largest:g} kg.",
            remedy="Give the mass that the hand holds, without the hand; more than the "
            "payload of the arm needs the robot's parameter service_limits/load_mass.",
            details=field_error("mass", f"must be 0 to {largest:g} kg", mass),
        )
    # The bound assumes that no part is farther than LOAD_DISTANCE from that centre.
    for field, values, size, bound, unit in (
        ("F_x_center_load", center, 3, LOAD_DISTANCE, "m"),
        ("load_inertia", inertia, 9, largest * LOAD_DISTANCE**2, "kg m^2"),
    ):
        if len(values) != size or not all(
            isfinite(value) and abs(value) <= bound for value in values
        ):
            raise InvalidCommandError(
                f"'{field}' of a load is {list(values)}; allowed are {size} numbers "
                f"from {-bound:g} to {bound:g} {unit}.",
                remedy="Give the values in metres and kilograms, in the flange frame.",
                details=field_error(
                    field,
                    f"must be {size} numbers from {-bound:g} to {bound:g} {unit}",
                    list(values),
                ),
            )


def field_error(
    field: str, message: str, value: object
) -> dict[str, list[dict[str, str]]]:
    """Return the details of an error about one field of a request.

    Args:
        field: Name of the field.
        message: Allowed values, as a part of a sentence.
        value: Value of the field.
    """
    error = {"field": f"body/{field}", "message": message, "value": str(value)}
    return {"errors": [error]}
