"""How soon a stop takes effect in each state of the station.

Run `python benchmarks/bench_stop.py`. The simulated Panda runs in its thread with the
default configuration. In each state somebody calls `Station.stop`; told are the cycles
from then to the cycle that stops every controller, and the time on the clock, medians
and maxima of several stops. While time stands still or is slowed down the loop makes
cycles without time passing; those are counted, too. How soon the watchdog stops a loop
that hangs is measured by `tests/system/`, with real processes.
"""

import argparse
import statistics
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter, sleep

from measuring import print_table, print_title
from typing_extensions import override

from station.app.composition import compose
from station.config import load_config
from station.core.control.controller import Controller
from station.core.control.controller_loader import TableLoader
from station.core.control.switching import SwitchRequest
from station.core.errors import StationError
from station.core.facade.station import Station
from station.core.franka.arms import Arms
from station.core.hardware.interfaces import EffortJointInterface
from station.core.parameters import Parameters
from station.core.scheduling import realtime_interpreter

ARM = "effort_group_position_controller"
CARTESIAN = "cartesian_streaming_controller"
POSE = [0.0, -0.785, 0.0, -2.356, 0.0, 1.571, 0.785]
LET_GO = threading.Event()


class Slow(Controller[EffortJointInterface]):
    """A controller whose init waits until it is let go."""

    hardware_interface = EffortJointInterface

    @override
    def init(self, interface: EffortJointInterface, params: Parameters) -> None:
        LET_GO.wait(5.0)


@contextmanager
def in_background(action: Callable[[], object]) -> Iterator[None]:
    """Run something that is refused or ended by the stop."""

    def run() -> None:
        try:
            action()
        except StationError:
            return  # the stop has ended it

    thread = threading.Thread(target=run)
    thread.start()
    sleep(0.002)
    try:
        yield
    finally:
        LET_GO.set()
        thread.join()
        LET_GO.clear()


@contextmanager
def idle(_: Station) -> Iterator[None]:
    """No controller that moves the arm runs."""
    yield


@contextmanager
def moving(station: Station) -> Iterator[None]:
    """A controller moves joint 1."""
    station.switch_controllers(SwitchRequest(start=[ARM]))
    station.motion.set_command(ARM, [0.3, *POSE[1:]])
    sleep(0.05)
    yield


@contextmanager
def paused(station: Station) -> Iterator[None]:
    """The same, and then time stands still."""
    with moving(station):
        station.simulation.change(paused=True)
        yield
    station.simulation.change(paused=False)


def at_factor(factor: float) -> Callable[[Station], object]:
    """The same at a real-time factor."""

    @contextmanager
    def state(station: Station) -> Iterator[None]:
        with moving(station):
            station.simulation.change(real_time_factor=factor)
            sleep(0.05)
            yield
        station.simulation.change(real_time_factor=1.0)

    return state


@contextmanager
def loading(station: Station) -> Iterator[None]:
    """The same, while the init of another controller does not return."""
    with (
        moving(station),
        in_background(lambda: station.load_controller("slow", "bench/Slow", {})),
    ):
        yield
    station.unload_controller("slow")


@contextmanager
def switching(station: Station) -> Iterator[None]:
    """A switch waits for the arm to come to rest."""
    request = SwitchRequest(start=[CARTESIAN], stop=[ARM])
    with moving(station), in_background(lambda: station.switch_controllers(request)):
        yield


@contextmanager
def resetting(station: Station) -> Iterator[None]:
    """The world is put back to its start."""
    with moving(station), in_background(station.simulation.reset):
        yield


@contextmanager
def recovering(station: Station) -> Iterator[None]:
    """The arm recovers from a reflex."""
    with moving(station):
        Arms(station.robots).set_user_stop("panda", pressed=True)
        with in_background(
            lambda: Arms(station.robots).set_user_stop("panda", pressed=False)
        ):
            yield


STATES: dict[str, Callable[[Station], object]] = {
    "idle": idle,
    "moving": moving,
    "paused": paused,
    "real-time factor 0.01": at_factor(0.01),
    "real-time factor 100": at_factor(100.0),
    "loading a controller that hangs": loading,
    "switching": switching,
    "resetting": resetting,
    "recovering": recovering,
}


def stop(station: Station) -> tuple[int, float]:
    """Stop the station; return how many cycles and seconds that took."""
    latch, loop = station.loop.stop_latch, station.loop
    cycle, begin = loop.cycle, perf_counter()
    station.stop("a benchmark")
    while latch.pending:
        sleep(0.0)
    return latch.cycle - cycle, perf_counter() - begin


def rearm(station: Station) -> None:
    """Allow motion again, and go back to the start.

    At a hundred times real time the controllers are updated so seldom that the arm may
    have gone to reflex.
    """
    station.release_stop(arm=False)
    station.release_stop(arm=True)
    station.simulation.reset()
    Arms(station.robots).set_user_stop("panda", pressed=True)
    Arms(station.robots).set_user_stop("panda", pressed=False)
    while station.latest().mode != "idle":
        sleep(0.001)


def main() -> None:
    """Measure every state and print the table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--repeats", type=int, default=7)
    repeats = parser.parse_args().repeats
    station = compose(load_config()).station
    station.loop.manager.register_loader(TableLoader({"bench/Slow": Slow}))
    rows: list[list[object]] = []
    with realtime_interpreter():
        station.loop.start()
        for name, state in STATES.items():
            found = []
            for _ in range(repeats):
                with state(station):  # type: ignore[attr-defined]  # a context manager
                    found.append(stop(station))
                rearm(station)
            cycles, times = zip(*found, strict=True)
            rows.append([
                name,
                statistics.median(cycles),
                max(cycles),
                1000.0 * statistics.median(times),
                1000.0 * max(times),
            ])
        station.loop.stop()
    print_title(f"From a stop to its cycle, {repeats} stops in each state")
    print_table(["state", "cycles", "at most", "ms", "at most"], rows)


if __name__ == "__main__":
    main()
