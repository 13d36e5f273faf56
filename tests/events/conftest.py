"""A station of one joint, and a controller of it that can be broken."""

from collections.abc import Callable

import pytest

from station.core.control.switching import SwitchRequest
from station.core.facade.station import Station
from tests.api.spring import make_station


@pytest.fixture
def station() -> Station:
    """A station that has made its first cycle."""
    station = make_station()
    station.loop.step()
    return station


@pytest.fixture
def load_spring(station: Station) -> Callable[[], None]:
    """Load the controller `spring`."""

    def load() -> None:
        station.load_controller("spring", "test/Spring", {"joint": "j"})

    return load


@pytest.fixture
def break_spring(
    station: Station, load_spring: Callable[[], None]
) -> Callable[[], None]:
    """Load and start the controller `spring`, which fails in its first cycle."""

    def fail(*_: object) -> None:
        raise RuntimeError("a broken spring")

    def break_it() -> None:
        load_spring()
        station.manager.get_controller("spring").update = fail
        station.switch_controllers(SwitchRequest(start=("spring",)))
        station.loop.step()

    return break_it
