"""The envelope of agents: how far, how fast and how hard their motions may be."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from station.reports import RehearsalCause, RehearsalFault

if TYPE_CHECKING:
    from station.rehearsal.run_ahead import Forecast


@dataclass(frozen=True, slots=True)
class Envelope:
    """Bounds of motions beside the robot's own. A workspace is a `fence` of the scene.

    Attributes:
        joints: Range of positions by joint [rad or m]; others have that of the robot.
        speed: Highest speed of any joint [rad/s or m/s]; None for the robot's own.
        force: Highest force of a contact [N]; None for any.
    """

    joints: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    speed: float | None = None
    force: float | None = None

    def fault(
        self, forecast: "Forecast", joints: Sequence[str], tube: float
    ) -> RehearsalFault | None:
        """Return the fault of a motion that leaves the envelope; None for any other.

        Args:
            forecast: What was rehearsed.
            joints: Names of the joints of its columns.
            tube: How far the robot may be from what was rehearsed [rad or m]: the
                ranges have to hold there, too.
        """
        report, q = forecast.rehearsal, forecast.positions
        for i, joint in enumerate(joints):
            low, high = self.joints.get(joint, (-np.inf, np.inf))
            outside = (q[:, i] < low + tube) | (q[:, i] > high - tube)
            if outside.any():
                k = int(np.argmax(outside))
                text = (
                    f"{joint} comes to {q[k, i]:.4f}; agents have {low:g} to {high:g}, "
                    f"less {tube:g} at both ends."
                )
                return _fault(report.begin_cycle + k, (k + 1), joint, text, forecast)
        for one in report.joints:
            if self.speed is not None and (one.velocity or 0.0) > self.speed:
                text = (
                    f"{one.joint} reaches {one.velocity:.3f}; the highest speed of "
                    f"agents is {self.speed:g}."
                )
                return _fault(report.begin_cycle, 0, one.joint, text, forecast)
        for contact in report.contacts:
            if self.force is not None and contact.force > self.force:
                text = (
                    f"{' and '.join(contact.bodies)} press with {contact.force:.1f} N; "
                    f"agents have {self.force:g} N."
                )
                return _fault(contact.cycle, 0, contact.bodies[0], text, forecast)
        return None

    def check_range(self, joint: str, lowest: float, highest: float) -> str | None:
        """Return a sentence if a joint may not go so far, or None.

        Args:
            joint: Name of the joint.
            lowest: Least position that it would reach [rad or m].
            highest: Greatest position that it would reach [rad or m].
        """
        low, high = self.joints.get(joint, (-np.inf, np.inf))
        if low <= lowest and highest <= high:
            return None
        return (
            f"{joint} would move from {lowest:.4f} to {highest:.4f}; agents have "
            f"{low:g} to {high:g}."
        )


def _fault(
    cycle: int, elapsed: int, where: str, text: str, forecast: "Forecast"
) -> RehearsalFault:
    cycles = max(forecast.rehearsal.cycles, 1)
    return RehearsalFault(
        RehearsalCause.ENVELOPE,
        cycle,
        forecast.rehearsal.duration * elapsed / cycles,
        where,
        [],
        "outside_envelope",
        text,
        0,
    )
