"""A user's robot that declares services of its own, and a station over it."""

from collections.abc import Sequence

from station.core.clock import ManualClock
from station.core.control.controller_loader import TableLoader
from station.core.control.controller_manager import ControllerManager
from station.core.errors import InvalidCommandError
from station.core.facade.station import Station
from station.core.hardware.services import (
    RobotServices,
    RobotServicesInterface,
    ServiceKind,
    service,
)
from station.core.loop.control_loop import ControlLoop
from station.core.parameters import Parameters
from station.hw.mock import MockRobotHW


class SwingServices(RobotServices):
    """Services of a swing."""

    def __init__(self, name: str) -> None:
        super().__init__(name)
        self.lengths = [1.0]
        self.pushes: list[tuple[float, bool]] = []

    @service(ServiceKind.SETTING)
    def set_lengths(self, lengths: Sequence[float]) -> None:
        """Set the lengths of the ropes.

        Args:
            lengths: Each > 0 [m].

        Raises:
            InvalidCommandError: A length is not positive.
        """
        if min(lengths) <= 0.0:
            raise InvalidCommandError(
                f"A length is {min(lengths)} m.", remedy="Give lengths above 0 m."
            )
        self.lengths = list(lengths)

    @service(moves=True)
    def push(self, impulse: float, gently: bool = False) -> dict[str, float]:  # noqa: FBT001, FBT002 - a service's parameter
        """Push the swing.

        It does not wait until the swing comes back.
        """
        self.pushes.append((impulse, gently))
        return {"impulse": impulse, "pushes": float(len(self.pushes))}

    @service(ServiceKind.QUERY)
    def length(self) -> float:
        """Return the length of the longest rope [m]."""
        return max(self.lengths)

    def oil(self) -> None:
        """Oil the joints, which is no service."""


class SwingHW(MockRobotHW):
    """A robot without joints whose services are those of a swing."""

    def __init__(self) -> None:
        super().__init__()
        self.swing = SwingServices("swing")
        services = RobotServicesInterface()
        services.register_handle(self.swing)
        self.register_interface(services)


def make_swing_station() -> Station:
    """Return a station over a swing that has run one cycle."""
    parameters, clock, hw = Parameters(), ManualClock(), SwingHW()
    hw.init(parameters, parameters)
    manager = ControllerManager(hw, parameters, [TableLoader({})], clock)
    station = Station(ControlLoop(hw, manager, clock=clock), manager, parameters)
    station.loop.step()
    return station
