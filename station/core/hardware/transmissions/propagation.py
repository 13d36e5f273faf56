"""Carry the values of many transmissions over, alike ones in one call."""

from collections.abc import Callable, Iterable, Sequence

from station.core.hardware.transmissions.simple_transmission import SimpleTransmission
from station.core.hardware.transmissions.transmission_handle import (
    Direction,
    QuantityMap,
    TransmissionHandle,
)
from station.core.hardware.transmissions.transmission_maps import (
    NO_OFFSET,
    ReducedValues,
)
from station.memory.doubles import as_doubles, doubles, indices

_EFFORTS = ("effort", "torque_sensor")
_POSITIONS = ("position", "absolute_position")


class Propagation:
    """Carries the values of some transmissions over, once per cycle. Control thread.

    Simple transmissions whose values are in the same doubles are carried over together;
    the others one after the other, with the same result.

    Args:
        handles: The transmissions. No two of them have the same target.
    """

    def __init__(self, handles: Iterable[TransmissionHandle] = ()) -> None:
        self._steps: list[Callable[[], None]] = []
        alike: dict[tuple[object, ...], list[QuantityMap]] = {}
        for handle in handles:
            for one in handle.maps:
                if _is_simple(one):
                    source, target = one.source[0][0], one.target[0][0]
                    key = (one.direction, one.quantity, id(source), id(target))
                    alike.setdefault(key, []).append(one)
                else:
                    self._steps.append(one.carry)
        self._steps += [_together(maps).carry for maps in alike.values()]

    def carry(self) -> None:
        """Carry the values of this cycle over."""
        for step in self._steps:
            step()


def _is_simple(one: QuantityMap) -> bool:
    # A class derived from it may have maps of its own.
    return type(one.transmission) is SimpleTransmission and all(
        isinstance(slots[0][0], memoryview) for slots in (one.source, one.target)
    )


def _together(maps: Sequence[QuantityMap]) -> ReducedValues:
    """Return one propagation of a quantity over some simple transmissions."""
    reductions = [
        one.transmission
        for one in maps
        if isinstance(one.transmission, SimpleTransmission)
    ]
    first = maps[0]
    to_joints = first.direction is Direction.ACTUATOR_TO_JOINT
    multiplies = (first.quantity in _EFFORTS) is to_joints
    offsets = [0.0 if multiplies else NO_OFFSET] * len(maps)
    if first.quantity in _POSITIONS:
        offsets = [one.joint_offset for one in reductions]
    return ReducedValues(
        as_doubles(first.source[0][0]),
        as_doubles(first.target[0][0]),
        source_places=indices([one.source[0][1] for one in maps]),
        target_places=indices([one.target[0][1] for one in maps]),
        reductions=doubles([one.reduction for one in reductions]),
        offsets=doubles(offsets),
        multiplies=multiplies,
    )
