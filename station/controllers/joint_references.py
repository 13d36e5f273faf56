"""Take references of joints from set-points, or from a preceding controller."""

from collections.abc import Callable, Sequence

from typing_extensions import override

from station.controllers.set_point_controller import JointQuantity
from station.core.control.chainable_controller import ChainableController, Reference
from station.core.description.robot_description import JointDescription
from station.core.parameters import Parameters
from station.core.ports.set_point import (
    ActiveSetPoint,
    SetPointElement,
    SetPointPort,
    read_command_timeout,
)
from station.memory.doubles import Doubles, put, zeros


class JointReferenceController(ChainableController):
    """A controller whose references are values of joints, perhaps with their rates.

    Set-points are values of the first quantity, with `rates` for the second.

    Attributes:
        references: The references of each quantity, shape (n,).
        exported_quantities: How many quantities are exported to other controllers.
    """

    references: Sequence[Doubles]
    exported_quantities: int

    def make_references(
        self,
        params: Parameters,
        joints: Sequence[JointDescription],
        quantities: Sequence[JointQuantity],
    ) -> None:
        """Make the references and the port of their set-points. For `init`.

        Args:
            params: The controller's namespace.
            joints: The joints of `joint_names`.
            quantities: One quantity, or one and its rate.
        """
        self._quantities = quantities
        self.exported_quantities = len(quantities)
        self.references = [zeros(len(joints)) for _ in quantities]
        elements = [
            [SetPointElement(j.name, kind.unit(j), *kind.range(j)) for j in joints]
            for kind in quantities
        ]
        timeout, action = read_command_timeout(params)
        self.set_points = SetPointPort(elements[0], timeout=timeout)
        if len(elements) > 1:
            self.set_points.feed_forward = elements[1]
        self._active = ActiveSetPoint(
            self.set_points, action, ", ".join(self.joint_names), lambda: self.rest(0)
        )

    def rest(self, n: int) -> list[float]:
        """Return the references of one quantity at which the joints rest, (n,)."""
        raise NotImplementedError

    def rest_reader(self, n: int, k: int) -> Callable[[], float]:
        """Return a function that reads one reference of a joint at rest."""
        return lambda: self.rest(n)[k]

    @override
    def on_export_reference_interfaces(self) -> Sequence[Reference]:
        pairs = zip(self._quantities, self.references, strict=True)
        return [
            Reference(f"{name}/{kind.value}", references, k, self.rest_reader(n, k))
            for n, (kind, references) in enumerate(pairs)
            if n < self.exported_quantities
            for k, name in enumerate(self.joint_names)
        ]

    @override
    def on_set_chained_mode(self, chained_mode: bool) -> bool:
        # A set-point from before the chain must not come back after it.
        if not chained_mode:
            self._active.start_at_rest()
        return True

    @override
    def starting(self, time: float) -> None:
        self._active.start_at_rest()
        for n, references in enumerate(self.references):
            put(references, self.rest(n))

    @override
    def update_reference_from_subscribers(self, time: float, period: float) -> None:
        put(self.references[0], self._active.newest())
        if len(self.references) > 1:
            rates = self._active.desired_rates if self._active.has_rates else None
            put(self.references[1], rates or self.rest(1))
