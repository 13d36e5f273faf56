"""Paths that play: to their end, in a loop, paused, slower, and broken off."""

import pytest

from station.core.control.switching import SwitchRequest
from station.core.errors import (
    InvalidTrajectoryError,
    PathRefusedError,
    WaypointPathNotFoundError,
)
from station.library.path_player import PathPlayer, PlayOptions
from station.library.waypoint_paths import WaypointPaths
from station.reports import PlaybackState, Waypoint
from tests.two_joint_station import make_station


class Player:
    """A player whose looks the test takes itself, and its station."""

    def __init__(self, folder):
        self.station = make_station()
        self.station.switch_controllers(SwitchRequest(start=("arm",)))
        self.station.loop.step(3)
        loop, manager = self.station.loop, self.station.manager
        self.paths = WaypointPaths(loop, manager, folder)
        ways = [("a", 0.5, 0.2), ("b", 0.5, 0.5), ("c", 0.5, 0.0)]
        self.paths.save("wave", [Waypoint(n, t, {"j1": q}) for n, t, q in ways])
        self.looks = []
        motion = self.station.motion
        self.player = PathPlayer(loop, manager, motion, self.paths, self.looks.append)

    def run(self, cycles):
        """Let time pass, with looks 20 times a second as those of the thread."""
        for _ in range(0, cycles, 50):
            self.station.loop.step(50)
            self.looks[-1]()
        return self.player.state()

    @property
    def q(self):
        return self.station.latest().position[0]


@pytest.fixture
def made(tmp_path):
    return Player(tmp_path / "paths")


def test_a_path_is_played_through_its_waypoints(made):
    begun = made.player.play("wave")
    assert (begun.state, begun.controller, begun.waypoints) == (
        PlaybackState.PLAYING,
        "arm",
        3,
    )
    middle = made.run(750)
    assert middle.waypoint == 1
    assert middle.progress == pytest.approx(0.5, abs=0.02)
    assert middle.remaining == pytest.approx(0.75, abs=0.06)
    assert 0.2 < made.q < 0.5
    end = made.run(900)
    assert (end.state, end.rounds, end.progress) == (PlaybackState.SUCCEEDED, 1, 1.0)
    assert made.q == pytest.approx(0.0, abs=1e-6)
    assert made.looks[-1]() is False


def test_some_of_its_waypoints_are_played(made):
    made.player.play("wave", PlayOptions(first=1, last=1))
    assert made.run(1200).state is PlaybackState.SUCCEEDED
    assert made.q == pytest.approx(0.5, abs=1e-6)


def test_a_loop_begins_again_until_it_is_switched_off(made):
    made.player.play("wave", PlayOptions(loop=True))
    assert made.run(2000).rounds == 1
    made.player.adjust(loop=False)
    end = made.run(2000)
    assert (end.state, end.rounds) == (PlaybackState.SUCCEEDED, 2)


def test_a_pause_holds_and_a_resume_goes_on_to_the_same_waypoint(made):
    made.player.play("wave")
    made.run(750)
    assert made.player.pause().state is PlaybackState.PAUSED
    made.run(600)
    held = made.q
    assert made.run(600).state is PlaybackState.PAUSED
    assert made.q == pytest.approx(held, abs=1e-9)
    assert made.player.resume().waypoint == 1
    assert made.run(1600).state is PlaybackState.SUCCEEDED
    assert made.q == pytest.approx(0.0, abs=1e-6)


def test_half_the_speed_takes_twice_the_time(made):
    made.player.play("wave", PlayOptions(speed=0.5))
    assert made.run(1500).waypoint == 1
    assert made.run(1600).state is PlaybackState.SUCCEEDED


def test_the_speed_changes_on_the_way(made):
    made.player.play("wave")
    made.run(250)
    before = made.player.state().remaining
    made.player.adjust(speed=0.25)
    assert made.player.state().remaining > 3.0 * before
    assert made.run(6000).state is PlaybackState.SUCCEEDED


def test_a_cancelled_path_holds_and_cannot_be_resumed(made):
    made.player.play("wave")
    made.run(500)
    assert made.player.cancel().state is PlaybackState.CANCELLED
    made.run(500)
    held = made.q
    made.run(500)
    assert made.q == pytest.approx(held, abs=1e-9)
    for ask in (made.player.resume, made.player.pause, made.player.cancel):
        with pytest.raises(PathRefusedError):
            ask()


def test_a_stop_ends_it_for_good_also_in_a_loop(made):
    made.player.play("wave", PlayOptions(loop=True))
    made.run(500)
    made.station.stop("a test")
    end = made.run(100)
    assert end.state is PlaybackState.ABORTED
    assert end.message
    made.station.release_stop(arm=False)
    made.station.release_stop(arm=True)
    assert made.run(500).state is PlaybackState.ABORTED


def test_a_stop_ends_a_paused_path(made):
    made.player.play("wave")
    made.run(200)
    made.player.pause()
    made.run(200)
    made.station.stop("a test")
    assert made.run(100).state is PlaybackState.ABORTED


def test_another_goal_ends_it(made):
    made.player.play("wave", PlayOptions(loop=True))
    made.run(200)
    rest = [0.0, 0.0]
    point = {
        "time_from_start": 0.5,
        "positions": [0.1, 0.0],
        "velocities": rest,
        "accelerations": rest,
    }
    trajectory = {"joint_names": ["j1", "j2"], "points": [point]}
    made.station.motion.submit_goal("arm", {"trajectory": trajectory})
    assert made.run(800).state is PlaybackState.ABORTED
    assert made.q == pytest.approx(0.1, abs=1e-6)


def test_a_path_replaces_the_one_that_plays(made):
    made.player.play("wave", PlayOptions(loop=True))
    made.run(200)
    made.player.play("wave", PlayOptions(first=1, last=1))
    assert made.looks[0]() is False
    assert made.run(1500).state is PlaybackState.SUCCEEDED
    assert made.q == pytest.approx(0.5, abs=1e-6)


def test_without_a_running_controller_it_says_which_to_start(made):
    made.station.switch_controllers(SwitchRequest(stop=("arm",)))
    made.station.loop.step(3)
    with pytest.raises(PathRefusedError) as caught:
        made.player.play("wave")
    assert caught.value.remedy == "Start one of: arm."
    assert caught.value.details == {"controllers": ["arm"]}
    assert made.player.state() is None


@pytest.mark.parametrize(("first", "last"), [(3, None), (-1, None), (2, 1), (0, 3)])
def test_waypoints_that_do_not_exist_are_refused(made, first, last):
    with pytest.raises(PathRefusedError, match="has 3 waypoints"):
        made.player.play("wave", PlayOptions(first=first, last=last))


def test_what_is_too_fast_is_refused_and_nothing_plays(made):
    made.paths.save("fast", [Waypoint("far", 0.2, {"j1": 1.0})])
    with pytest.raises(InvalidTrajectoryError, match="its limit is 2 rad/s"):
        made.player.play("fast")
    assert made.player.state() is None


def test_a_speed_that_is_too_fast_leaves_the_path_as_it_is(made):
    made.paths.save("brisk", [Waypoint("far", 0.6, {"j1": 1.0})])
    made.player.play("brisk", PlayOptions(speed=0.5))
    made.run(100)
    with pytest.raises(InvalidTrajectoryError):
        made.player.adjust(speed=2.0)
    assert made.player.state().speed == 0.5
    assert made.run(2400).state is PlaybackState.SUCCEEDED


def test_an_unknown_path_is_refused(made):
    with pytest.raises(WaypointPathNotFoundError):
        made.player.play("nothing")
