"""A station that records what the command line asks of it."""

from argparse import Namespace
from dataclasses import replace

import pytest

from station.cli import main
from station.client import ApiError, StationClient
from station.client.blocking import _Source
from station.core.control.controller_factory import ControllerType as CoreControllerType
from station.core.ports.set_point import (
    timeout_parameters,
)
from station.reports import (
    AgentRequest,
    ComponentInterface,
    HardwareComponentReport,
    Plan,
    Verdict,
)
from station.wire import (
    ArmReport,
    ChainedController,
    CommandAccepted,
    ControllerChains,
    ControllerState,
    ControllerType,
    ControlState,
    DesiredState,
    ExportedValue,
    Gains,
    GainsChange,
    GainSet,
    Goal,
    NewToken,
    Percentiles,
    Recoveries,
    Recovery,
    Simulation,
    StopState,
    StreamFrame,
    SwitchResult,
    Token,
    Tunable,
)

GROUP = "position_controllers/JointGroupPositionController"
DESCRIBED = CoreControllerType(
    GROUP, "Base", "Forwards positions.", timeout_parameters(0.2, longest=1.0)
)


class FakeSimulation:
    """What `SimulationClient` is to the command line."""

    def __init__(self, station: "FakeStation") -> None:
        self._station = station
        self.paused = False

    def record(self, *call: object) -> Simulation:
        self._station.record(*call)
        return Simulation(
            paused=self.paused, real_time_factor=0.5, time=1.25, steps_due=0
        )

    def pause(self):
        self.paused = True
        return self.record("pause")

    def resume(self):
        self.paused = False
        return self.record("resume")

    def step(self, n):
        self.paused = True
        return self.record("step", n)

    def reset(self, joint_positions, keyframe):
        named = () if keyframe is None else (keyframe,)
        return self.record("reset", joint_positions, *named)


class FakeGainSets:
    """The gain sets of the fake station."""

    def __init__(self, station):
        self._station = station
        self._set = GainSet.model_validate({
            "name": "stiff",
            "saved_at": "now",
            "gains": {"arm": {"j1/p": 600.0}},
            "differences": [
                {"controller": "arm", "name": "j1/p", "saved": 600.0, "present": 5.0}
            ],
        })
        self._change = GainsChange(
            values={"j1/p": 600.0, "j1/d": 1.0},
            previous={"j1/p": 5.0, "j1/d": 1.0},
            revision=2,
            cycle=9,
        )

    def names(self):
        return ["soft", "stiff"]

    def get(self, name):
        self._station.record("get_set", name)
        return self._set

    def save(self, name, controllers):
        self._station.record("save", name, controllers)
        return self._set

    def delete(self, name):
        self._station.record("delete_set", name)
        return self._set

    def apply(self, name, controllers):
        self._station.record("apply", name, controllers)
        return {"arm": self._change}

    def undo(self):
        self._station.record("undo")
        return {"arm": self._change}


class _Awaited(_Source):
    """What a client for asyncio is, over a fake."""

    def __init__(self, fake):
        super().__init__("http://a", "t")
        self._fake = fake

    async def controllers(self):
        return self._fake.controllers()

    async def switch_controllers(self, **request):
        return self._fake.switch_controllers(**request)

    async def query_state(self, name, time=None):
        return self._fake.query_state(name)

    async def submit_goal(self, name, goal, epoch=None, certificate=None):
        return self._fake.submit_goal(name, goal, certificate)

    async def plan(self, controller, target):
        return self._fake.plan(controller, target)

    async def goal(self, name, goal_id):
        return self._fake.goal(name, goal_id)

    async def cancel_goal(self, name, goal_id):
        return self._fake.cancel_goal(name, goal_id)


class FakeStation:
    """What `StationClient` is to the command line; keeps every call."""

    def __init__(self) -> None:
        self.timeout = 10.0
        self.calls: list[tuple[object, ...]] = []
        self.outcome = "committed"
        self.component = HardwareComponentReport(
            "left",
            "system",
            "franka_hw/FrankaHW",
            "inactive",
            "no cable",
            (ComponentInterface("EffortJoint", "j1", is_available=False),),
            (ComponentInterface("JointState", "j1", is_available=True),),
        )
        self.states = {"arm": "running", "leg": "stopped"}
        self.frames: list[StreamFrame] = []
        self.faults: dict[str, str] = {}
        self.failed: dict[str, str] = {}
        self.goals: list[Goal] = []
        self.trajectory_controllers: list[str] = []
        self.refusal: BaseException | None = None
        self.simulation = FakeSimulation(self)
        self.tokens = FakeTokens(self)
        self.agents = FakeAgents(self)
        self.control_found = ControlState()
        self.acts_under = None
        self.gain_sets = FakeGainSets(self)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        return None

    def record(self, *call: object) -> None:
        self.calls.append(call)
        if self.refusal is not None:
            raise self.refusal

    def controllers(self):
        self.record("controllers")
        found = [self.controller(name) for name in self.states]
        for name in self.trajectory_controllers:
            kind = f"{name.partition('_')[0]}_controllers/JointTrajectoryController"
            update = {"name": name, "type": kind, "state": "initialized"}
            found.append(found[0].model_copy(update=update))
        return found

    def controller(self, name):
        claims = [{"hardware_interface": "PositionJoint", "resources": ["j1", "j2"]}]
        return ControllerState(
            name=name,
            type=GROUP,
            state=self.states[name],
            claimed_resources=claims,
            fault=self.faults.get(name),
            traceback=None,
            fallback=[],
            time=Percentiles(p50=0.0, p99=2e-5, p999=0.0, max=0.0, count=9),
        )

    def hardware_components(self):
        return [self.component]

    def set_hardware_component_state(self, name, state, **options):
        self.record("component", name, state, options)
        return replace(self.component, state=state)

    def chains(self):
        reference = ExportedValue("wheel/joint/velocity", ("diff",))
        return ControllerChains((
            ChainedController(
                "diff",
                "running",
                is_in_chained_mode=False,
                following=("wheel",),
                references=(),
                states=(),
            ),
            ChainedController(
                "wheel",
                "running",
                is_in_chained_mode=True,
                following=(),
                references=(reference,),
                states=(),
            ),
        ))

    def controller_types(self):
        return [ControllerType.model_validate(DESCRIBED)]

    def parameter(self, path):
        self.record("parameter", path)
        return {"p": 1.0}

    def set_parameter(self, path, value):
        self.record("set_parameter", path, value)

    def delete_parameter(self, path):
        self.record("delete_parameter", path)
        return 3

    def reload_controller_types(self, *, force_kill):
        self.record("reload", force_kill)
        return ["arm"] if force_kill else []

    def query_state(self, name):
        if name in self.trajectory_controllers:
            return DesiredState(
                name=[f"panda_joint{number}" for number in range(1, 8)],
                position=[0.0] * 7,
                velocity=[0.0] * 7,
                acceleration=[0.0] * 7,
            )
        return DesiredState(
            name=["j1", "j2"],
            position=[0.5, None],
            velocity=[0.0, 0.0],
            acceleration=[0.0, 0.0],
        )

    def _client(self):
        client = StationClient("http://a", "t")
        client._source = _Awaited(self)
        return client

    def start_move(self, *arguments, **options):
        return self._client().start_move(*arguments, **options)

    def start_motion_sequence(self, *arguments):
        return self._client().start_motion_sequence(*arguments)

    def rehearse(self, steps, *, seconds=None, certificate=False):
        self.record("rehearse", steps, seconds, certificate)
        return self.rehearsal

    def plan(self, controller, target):
        self.record("plan", controller, target)
        return Plan(
            controller,
            {"trajectory": {}},
            duration=1.0,
            direct=True,
            planning_time=0.0,
            joints=["j1"],
            positions=[],
        )

    def submit_goal(self, name, goal, certificate):
        self.record("submit_goal", name, goal, *([certificate] if certificate else []))
        return self.goals.pop(0)

    def goal(self, name, goal_id):
        self.record("goal", name, goal_id)
        return self.goals.pop(0)

    def cancel_goal(self, name, goal_id):
        self.record("cancel_goal", name, goal_id)

    def load_controller(
        self,
        name,
        type=None,  # noqa: A002
        params=None,
        *,
        timeout=None,
        unknown_params="refuse",
    ):
        self.record("load", name, type, params)
        self.load_timeout, self.unknown_params = timeout, unknown_params
        self.states[name] = "initialized"
        return self.controller(name)

    def unload_controller(self, name):
        self.record("unload", name)
        return self.controller(name)

    def switch_controllers(self, **request):
        self.record("switch", request)
        return SwitchResult(
            ok=not self.failed and self.outcome == "committed",
            failed=self.failed,
            ignored=[],
            started=list(request.get("start", ())),
            stopped=list(request.get("stop", ())),
            outcome=self.outcome,
            jump={"j1": 0.0, "j2": 0.25},
            cycle=7,
            dry_run=request.get("dry_run", False),
        )

    def gains(self, name):
        tunable = Tunable(unit="Nm/rad", minimum=0.0, maximum=None)
        return Gains(
            values={"j1/p": 600.0}, schema={"j1/p": tunable}, revision=1, etag='"1"'
        )

    def set_gains(self, name, values):
        self.record("set_gains", name, values)
        previous = dict.fromkeys(values, 600.0)
        return GainsChange(values=values, previous=previous, revision=2, cycle=9)

    def download_config(self, name, target):
        target.write_text(f"{name}: {{gains: {{j1: {{p: 500.0}}}}}}\n", "utf-8")
        return target

    def command(self, name, values, *, certificate):
        self.record("command", name, values, *([certificate] if certificate else []))
        return CommandAccepted(epoch=3)

    def stop(self, reason):
        self.record("stop", reason)
        return self._stop_state("stopped")

    def release_stop(self, *, arm):
        self.record("release", arm)
        return self._stop_state("armed" if arm else "released")

    def recover_all(self, restart):
        """Recover two arms."""
        self.record("recover_all", restart)
        robots = [_report("left"), _report("right")]
        return Recoveries(robots=robots, restarted=["arm"] if restart != "none" else [])

    def robot(self, arm_id):
        """Return the client of an arm."""
        return _FakeArm(self, arm_id)

    def _stop_state(self, state):
        return StopState(state=state, reason="", epoch=2)

    @property
    def lease(self):
        """What takes control and gives it back."""
        return self

    def act_under(self, lease):
        self.acts_under = lease

    def state(self):
        return self.control_found

    def release(self):
        self.record("release")
        return ControlState()

    def control(self, owner, **options):
        self.record("control", owner, options)
        return _FakeLease()

    def events(self, since, **options):
        self.record("events", since, options)
        return self.happened

    def stream(self, topic, **options):
        self.record("stream", topic, options)
        return _FakeStream(self.frames)


def _report(arm_id):
    return ArmReport(
        arm_id=arm_id,
        robot_mode="idle",
        connected=True,
        errors=[],
        remedy="release the user stop" if arm_id == "right" else "",
        caution="It is touched." if arm_id == "left" else "",
    )


class _FakeLease:
    """Control that is lost at once."""

    lost = ApiError("Grace holds control.", status=423, code="control_held", remedy="")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        return None

    def renew(self):
        return ControlState(owner="Ada", since=0.0, mine=True, lease="key")


class FakeTokens:
    """What `TokensClient` is to the command line."""

    def __init__(self, station: "FakeStation") -> None:
        self._station = station

    def list(self):
        return [Token(name="ada", role="viewer", created=0.0, expires_at=None)]

    def create(self, name, role, expires=None):
        self._station.record("create", name, role, expires)
        return NewToken(
            name=name, role=role, created=0.0, expires_at=expires, token="secret"
        )

    def revoke(self, name):
        self._station.record("revoke", name)
        return self.list()[0]


class FakeAgents:
    """What `AgentsClient` is to the command line."""

    def __init__(self, station: "FakeStation") -> None:
        self._station = station
        self.request = AgentRequest(
            "q3TZ", "tuner", "grasp", "panda", {"width": 0.04}, 0.0, 60.0
        )

    def requests(self):
        return [self.request]

    def answer(self, number, verdict):
        self._station.record("answer", number, verdict)
        return replace(self.request, verdict=Verdict(verdict), decided_by="ada")


class _FakeArm:
    def __init__(self, station, arm_id):
        self.station, self.arm_id = station, arm_id

    def recover(self, restart):
        """Recover."""
        self.station.calls.append(("recover", self.arm_id, restart))
        restarted = ["arm"] if restart != "none" else []
        return Recovery(**dict(_report(self.arm_id)), restarted=restarted)


class _FakeStream(list):
    """Frames, as a stream hands them out."""

    def __enter__(self):
        return self

    def __exit__(self, *_):
        return None


@pytest.fixture
def station(monkeypatch):
    """Return the station that every verb finds."""
    fake = FakeStation()
    monkeypatch.setattr("station.client.StationClient", lambda *_, **_options: fake)
    monkeypatch.setenv("STATION_URL", "http://127.0.0.1:8000")
    monkeypatch.setenv("STATION_TOKEN", "secret")
    return fake


class Outcome(Namespace):
    """What a command line came to: `code`, `out`, `err`."""


@pytest.fixture
def run(capsys, station):  # noqa: ARG001 - every verb finds it
    """Return a function that runs a command line."""

    def run_line(line: str) -> Outcome:
        code = main(line.split())
        out, err = capsys.readouterr()
        return Outcome(code=code, out=out, err=err)

    return run_line
