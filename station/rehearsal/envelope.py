"""The envelope of agents: bounds on range, speed and force of their motions."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from station.reports import RehearsalCause, RehearsalFault

if TYPE_CHECKING:
    from station.rehearsal.run_ahead import Forecast

Hands = Mapping[str, Callable[[NDArray[np.float64]], Sequence[float]]]
"""Functions by the arm's name. Each returns the position of an end effector in the base
frame of its arm [m], shape (3,), from the positions of all joints [rad or m]."""


@dataclass(frozen=True, slots=True)
class Envelope:
    """Bounds on motions, in addition to the robot's limits.

    Attributes:
        joints: Range of positions by joint [rad or m]; other joints have only the
            robot's limits.
        workspace: Ranges of x, y and z of end effectors in the base frame of their arm
            [m]; an axis without a range is free. To bound all links, use a `fence` of
            the scene.
        speed: Highest speed of any joint [rad/s or m/s]; None for the robot's limits
            only.
        force: Highest force of a contact [N]; None for no bound.
    """

    joints: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    workspace: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    speed: float | None = None
    force: float | None = None

    def fault(
        self,
        forecast: "Forecast",
        joints: Sequence[str],
        tube: float,
        hands: Hands,
    ) -> RehearsalFault | None:
        """Return the fault of a motion that leaves the envelope, or None.

        Args:
            forecast: The rehearsed motion.
            joints: Names of the joints, in the order of the columns of
                `forecast.positions`.
            tube: Largest distance from the rehearsed motion [rad or m]; the ranges must
                hold at that distance, too.
            hands: The end effectors, for the workspace.
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
        for k in range(len(q) if self.workspace else 0):
            found = self._outside(q[k], hands)
            if found is not None:
                where, text = found
                return _fault(report.begin_cycle + k, (k + 1), where, text, forecast)
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

    def check_range(
        self,
        q: NDArray[np.float64],
        joints: Sequence[str],
        joint: str,
        size: float,
        hands: Hands,
    ) -> str | None:
        """Return the reason why a joint may not move so far; None if it may.

        Args:
            q: Positions of all joints [rad or m], shape (n,).
            joints: Their names.
            joint: Name of the joint that is tested.
            size: Largest offset from its present position [rad or m].
            hands: The end effectors, for the workspace.
        """
        index = list(joints).index(joint)
        lowest, highest = q[index] - abs(size), q[index] + abs(size)
        low, high = self.joints.get(joint, (-np.inf, np.inf))
        if not (low <= lowest and highest <= high):
            return (
                f"{joint} would move from {lowest:.4g} to {highest:.4g}; agents have "
                f"{low:g} to {high:g}."
            )
        # The hand moves on an arc, so check between its ends, too. With these steps the
        # hand of the longest arm moves about 1 cm. The bench refuses larger sizes.
        for angle in np.linspace(lowest, highest, 2 + int(200.0 * min(abs(size), 4))):
            reached = q.copy()
            reached[index] = angle
            found = self._outside(reached, hands)
            if found is not None:
                return found[1]
        return None

    def _outside(self, q: NDArray[np.float64], hands: Hands) -> tuple[str, str] | None:
        """Return the arm whose hand is outside of the workspace, and a sentence."""
        if not self.workspace:
            return None
        for arm, place in hands.items():
            for axis, value in zip("xyz", place(q), strict=True):
                low, high = self.workspace.get(axis, (-np.inf, np.inf))
                if not low <= value <= high:
                    return arm, (
                        f"The hand of {arm} comes to {axis} = {value:.4f} m; agents "
                        f"have {low:g} to {high:g}."
                    )
        return None


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
