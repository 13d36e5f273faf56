"""Any order of requests leaves the loop running, claims consistent, the arm in limits.

The requests are those of a person who does not read the manual: they come while the
station is stopped, paused, in reflex, with controllers that are not loaded.
"""

from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from hypothesis import HealthCheck, Phase, settings, strategies as st
from hypothesis.stateful import (
    RuleBasedStateMachine,
    invariant,
    precondition,
    rule,
    run_state_machine_as_test,
)

from station.api.app import Kept, create_app
from station.api.auth import Authenticator
from station.client import ApiError, StationClient
from station.core.control.controller import ControllerState
from station.records.record_store import RecordStore
from station.records.recorder import Recorder
from station.reports import LoopState
from station.wire import Fault
from tests.api.conftest import OPERATOR, URL, VIEWER, AppTransport
from tests.franka_station import JOINTS, make_franka_station

pytestmark = pytest.mark.long

CONTROLLERS = {
    "arm": "position_controllers/JointGroupPositionController",
    "effort": "effort_controllers/JointGroupPositionController",
    "velocity": "velocity_controllers/JointGroupVelocityController",
    "trajectory": "position_controllers/JointTrajectoryController",
    "states": "joint_state_controller/JointStateController",
}
PIDS = {joint: {"pid": {"p": 100.0, "i": 0.0, "d": 5.0}} for joint in JOINTS}
NAMES = st.sampled_from([*CONTROLLERS, "nobody"])
POSITIONS = st.lists(st.floats(-3.0, 3.0), min_size=7, max_size=7) | st.just([
    0.0,
    -0.785,
    0.0,
    -2.356,
    0.0,
    1.571,
    0.785,
])
KINDS = st.sampled_from(["collision", "lost_packets", "stuck_joint", "nan_sensor"])


class Requests(RuleBasedStateMachine):
    """A station over a simulated arm, asked over its API and stepped in between."""

    def __init__(self):
        super().__init__()
        self.folder = TemporaryDirectory()
        self.station = make_franka_station()
        self.recorder = Recorder(
            self.station, RecordStore(Path(self.folder.name, "recordings"))
        )
        app = create_app(
            self.station,
            Authenticator(OPERATOR, VIEWER),
            kept=Kept(
                recorder=self.recorder, gain_sets=Path(self.folder.name, "gains")
            ),
        )
        self.client = StationClient(URL, OPERATOR, transport=AppTransport(app))
        self.other = StationClient(URL, OPERATOR, transport=AppTransport(app))
        self.limits = {
            found.joint: (found.limits.min_position, found.limits.max_position)
            for found in self.station.hardware().limits
        }

    def teardown(self):
        self.recorder.close()
        self.client.close()
        self.other.close()
        self.folder.cleanup()

    def ask(self, request):
        """Send a request; a refusal is an answer, a fault of the server is none."""
        refusal = None
        try:
            request(self.client)
        except ApiError as error:
            refusal = error
        if refusal is not None:
            assert refusal.status in {404, 409, 412, 422, 423}, refusal
            assert refusal.detail
            assert refusal.remedy
        self.station.loop.step(3)

    @rule(name=st.sampled_from(sorted(CONTROLLERS)))
    def load(self, name):
        params = {"joints": JOINTS, **PIDS}
        self.ask(lambda client: client.load_controller(name, CONTROLLERS[name], params))

    @rule(name=NAMES)
    def unload(self, name):
        self.ask(lambda client: client.unload_controller(name))

    @rule(
        start=st.lists(NAMES, max_size=2, unique=True),
        stop=st.lists(NAMES, max_size=2, unique=True),
        strictness=st.sampled_from(["strict", "best_effort"]),
        dry_run=st.booleans(),
    )
    def switch(self, start, stop, strictness, dry_run):
        if start or stop:
            self.ask(
                lambda client: client.switch_controllers(
                    start=start, stop=stop, strictness=strictness, dry_run=dry_run
                )
            )

    @rule(name=NAMES, values=POSITIONS, epoch=st.none() | st.integers(0, 3))
    def command(self, name, values, epoch):
        self.ask(lambda client: client.command(name, values, epoch))

    @rule(name=NAMES, values=POSITIONS, time=st.floats(0.01, 3.0))
    def send_goal(self, name, values, time):
        point = {"positions": values, "time_from_start": time}
        goal = {"trajectory": {"joint_names": JOINTS, "points": [point]}}
        self.ask(lambda client: client.submit_goal(name, goal))

    @rule(name=NAMES, value=st.floats(-1.0, 2000.0))
    def tune(self, name, value):
        self.ask(lambda client: client.set_gains(name, {"panda_joint1/p": value}))

    @rule()
    def undo(self):
        self.ask(lambda client: client.gain_sets.undo())

    @rule(name=st.sampled_from(["a", "b"]))
    def save_gains(self, name):
        self.ask(lambda client: client.gain_sets.save(name))

    @rule(name=st.sampled_from(["a", "b", "never"]))
    def apply_gains(self, name):
        self.ask(lambda client: client.gain_sets.apply(name))

    @rule(force=st.booleans(), others=st.booleans())
    def take_control(self, force, others):
        asks, owner = (self.other, "other") if others else (self.client, "me")

        def take(_):
            taken = asks.lease.take(owner, ttl=600.0, force=force)
            asks.lease.act_under(taken.lease)

        self.ask(take)

    @rule(others=st.booleans())
    def give_control_back(self, others):
        self.ask(lambda _: (self.other if others else self.client).lease.release())

    @rule()
    def start_recording(self):
        self.ask(lambda client: client.recordings.start("any"))

    @rule()
    def stop_recording(self):
        last = self.recorder.last
        name = "20260101T000000000-never" if last is None else last.identifier
        self.ask(lambda client: client.recordings.stop(name))

    @rule(path=st.sampled_from(["arm/joints", "new/a", "new/a/b", "robot/x"]))
    def set_parameter(self, path):
        self.ask(lambda client: client.set_parameter(path, 5))

    @rule()
    def stop(self):
        self.ask(lambda client: client.stop("test"))

    @rule(arm=st.booleans())
    def release(self, arm):
        self.ask(lambda client: client.release_stop(arm=arm))

    @rule(kind=KINDS)
    def inject(self, kind):
        fault = Fault(kind=kind, cycles=30)
        self.ask(lambda client: client.robot("panda").inject(fault))

    @rule(restart=st.sampled_from(["none", "previous"]))
    def recover(self, restart):
        self.ask(lambda client: client.recover_all(restart))

    @rule(pressed=st.booleans())
    def press_user_stop(self, pressed):
        self.ask(lambda client: client.robot("panda").user_stop(pressed=pressed))

    @rule(paused=st.booleans())
    def pause(self, paused):
        simulation = self.client.simulation
        self.ask(lambda _: simulation.pause() if paused else simulation.resume())

    @rule(keyframe=st.sampled_from([None, "ready", "default", "nowhere"]))
    def reset(self, keyframe):
        self.ask(lambda client: client.simulation.reset(keyframe=keyframe))

    @rule(force=st.booleans())
    def reload(self, force):
        self.ask(lambda client: client.reload_controller_types(force_kill=force))

    @precondition(lambda self: self.station.loop.cycle < 5_000)
    @rule(cycles=st.integers(1, 200))
    def wait(self, cycles):
        self.station.loop.step(cycles)

    @invariant()
    def the_loop_runs(self):
        assert self.station.loop.state is not LoopState.FAILED
        before = self.station.loop.cycle
        self.station.loop.step()
        assert self.station.loop.cycle == before + 1

    @invariant()
    def no_resource_has_two_owners(self):
        for interface in self.station.hardware().interfaces:
            if "State" in interface.name:
                continue  # read by many
            for resource in interface.resources:
                assert len(resource.claimed_by) <= 1, resource

    @invariant()
    def who_claims_runs_and_is_loaded(self):
        running = {
            status.name
            for status in self.station.controllers()
            if status.state is ControllerState.RUNNING
        }
        claimed = {
            name
            for interface in self.station.hardware().interfaces
            for resource in interface.resources
            for name in resource.claimed_by
        }
        assert claimed <= running

    @invariant()
    def a_stopped_station_runs_nothing(self):
        if self.station.loop.stop_latch.state.value != "armed":
            assert self.station.manager.running_names() == []

    @invariant()
    def the_arm_is_within_its_limits(self):
        snapshot = self.station.latest()
        places = zip(self.station.joint_names, snapshot.position, strict=True)
        for joint, position in places:
            if position != position:
                continue  # a sensor that was made to read NaN
            low, high = self.limits[joint]
            assert low - 0.01 <= position <= high + 0.01, joint

    @invariant()
    def whoever_does_not_hold_control_is_locked_out(self):
        owner = self.client.lease.state().owner
        if owner is not None:
            outsider = self.client if owner == "other" else self.other
            with pytest.raises(ApiError) as caught:
                outsider.reset_loop_statistics()
            assert caught.value.status == 423

    @invariant()
    def the_recorder_lives_and_loses_nothing(self):
        self.recorder.drain()
        assert self.recorder.failure is None
        last = self.recorder.last
        assert last is None or last.lost == 0

    @invariant()
    def the_api_answers(self):
        status = self.client.status()
        assert status.cycle == self.station.loop.cycle
        assert [arm.arm_id for arm in self.client.robots()] == ["panda"]


def test_any_order_of_requests_leaves_the_station_whole():
    run_state_machine_as_test(
        Requests,
        settings=settings(
            max_examples=15,
            stateful_step_count=25,
            deadline=None,
            derandomize=True,
            database=None,
            phases=[Phase.generate],
            suppress_health_check=list(HealthCheck),
        ),
    )
