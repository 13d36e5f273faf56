"""A rehearsal on a real arm: a model with its settings is moved, and the arm is not."""

from functools import partial

import pytest

from station.app.composition import compose
from station.app.twin import Likeness, run_model
from station.config import load_config
from station.core.clock import ManualClock
from station.core.control.switching import SwitchRequest
from station.core.description.robot_files import load_robot_files
from station.core.errors import InvalidCommandError, NoPathError, RehearsalError
from station.core.franka.franka_services import FrankaServices
from station.core.ports.goal import GoalStatus
from station.hw.franka.fci.driver import connection
from station.hw.franka.fci.driver.network import FciNetworkError
from station.hw.franka.fci.wire.gripper_protocol import HAND
from station.hw.franka.simulated.franka_world import ArmPlacement, simulate
from station.rehearsal.planning import Wish
from station.rehearsal.rehearsals import Rehearsals
from station.reports import RehearsalCause, RehearsalOutcome
from tests.hw.franka.fci.stepped_network import SteppedNetwork
from tests.rehearsal.test_rehearsals import EFFORTS, POSITION, goal, moved, set_point

JOINTS = "[" + ", ".join(f"panda_joint{i}" for i in range(1, 8)) + "]"
CONFIG = f"""
robot:
  type: franka_hw/FrankaHW
  arm_id: panda
  robot_description: example-robot-data:panda
  realism: ideal
  robot_ip: 172.16.0.2
  realtime_config: ignore
controllers:
  {POSITION}: {{type: position_controllers/JointTrajectoryController, joints: {JOINTS}}}
  {EFFORTS}: {{type: effort_controllers/JointGroupEffortController, joints: {JOINTS}}}
start: []
"""
TUNED = "tuned"
START = moved(j1=0.2, j4=-0.1)


class RealArm:
    """A station whose arm is behind the Franka Control Interface.

    Attributes:
        arm: The arm at the other end.
        facade: The station.
        rehearsals: Its rehearsals.
    """

    def __init__(self, monkeypatch, tmp_path):
        description = load_robot_files("example-robot-data:panda")
        world = simulate([ArmPlacement("panda", description)])
        world.reset({f"panda_joint{i}": q for i, q in enumerate(START, 1)})
        self.arm = world.arms["panda"]
        network = SteppedNetwork(self.arm)

        def open_network(_host, port):
            if port == HAND.port:
                raise FciNetworkError("There is no hand.")
            return network

        monkeypatch.setattr(connection, "FciNetwork", open_network)
        path = tmp_path / "station.yaml"
        path.write_text(CONFIG, encoding="utf-8")
        config = load_config(path)
        self.facade = compose(config, ManualClock()).station
        self.facade.manager.pump = self.step
        self.config = config
        self.rehearsals = Rehearsals(self.facade, run_model=partial(run_model, config))
        self.step(10)
        self.facade.switch_controllers(SwitchRequest(start=[POSITION]))
        self.step(200)

    def run_here(self, station, work):
        return work(Likeness.of(self.config, station).build())

    def step(self, cycles=1):
        self.facade.loop.step(cycles, self.facade.loop.period)


@pytest.fixture
def real(monkeypatch, tmp_path):
    """A station with a real arm that stands still."""
    made = RealArm(monkeypatch, tmp_path)
    yield made
    made.facade.loop.hw.close()


def test_model_moves_as_the_real_arm_would_and_the_arm_does_not(real):
    before, cycle = real.arm.state.q, real.facade.loop.cycle
    target = moved(j1=-0.2, j6=0.2)
    steps = goal(POSITION, target, 1.0)

    told = real.rehearsals.rehearse(steps, certify=True)

    assert (told.outcome, told.twin) == (RehearsalOutcome.COMPLETED, "model")
    assert told.positions[0] == pytest.approx(START, abs=1e-3)
    assert told.positions[-1] == pytest.approx(target, abs=2e-3)
    assert (real.arm.state.q, real.facade.loop.cycle) == (before, cycle)

    # What the certificate asks for is what the real arm has, and the tube holds.
    command = {key: value for key, value in steps[0].items() if key != "at"}
    with real.rehearsals.redeemed(told.certificate.name, command) as ticket:
        real.facade.motion.submit_goal(POSITION, steps[0]["request"], ticket=ticket)
    real.step(told.cycles)
    assert real.facade.latest().position == pytest.approx(target, abs=2e-3)
    assert real.facade.status().stop_reason == ""


def test_model_plans_around_a_role_and_the_real_arm_follows(real):
    place = {"type": "box", "size": [0.08, 0.08, 1.0], "position": [0.2, 0.34, 0.5]}
    real.facade.surroundings.put("post", {**place, "role": "keep_out"})
    wish = Wish(POSITION, {"panda_joint1": 1.8}, timeout=20.0)
    # Without a process of its own, which takes a second.
    found = Rehearsals(real.facade, run_model=real.run_here).plan(wish)
    assert (found.twin, found.direct) == ("model", False)
    submitted = real.facade.motion.submit_goal(POSITION, found.goal)
    least = 1.0
    for _ in range(int(1000 * found.duration) + 500):
        real.step()
        least = min(least, real.facade.surroundings.clearance("panda").distance)
    assert submitted.status is GoalStatus.SUCCEEDED
    assert least >= 0.02
    assert real.arm.state.q[0] == pytest.approx(1.8, abs=2e-3)


@pytest.mark.slow
def test_refusal_of_a_plan_by_the_model_keeps_its_kind_and_its_facts(real):
    with pytest.raises(NoPathError, match="cannot get there") as far:
        real.rehearsals.plan(Wish(POSITION, place=([1.5, 0.0, 0.5], None)))
    assert far.value.details["cause"] == "unreachable"


def test_poses_with_a_name_are_those_of_the_model(real):
    here = Rehearsals(real.facade, run_model=real.run_here)
    with pytest.raises(InvalidCommandError, match="no pose 'reddy'"):
        here.plan(Wish(POSITION, name="reddy"))


def test_error_of_the_model_is_told_with_its_cause(real):
    throw = set_point(EFFORTS, [0.0, 0.0, 0.0, 40.0, 0.0, 0.0, 0.0])
    swap = {"kind": "switch", "start": [EFFORTS], "stop": [POSITION], "at": 0.0}
    before = real.arm.state.q

    # Without a process of its own, which takes a second.
    here = Rehearsals(real.facade, run_model=real.run_here)
    told = here.rehearse([swap, *throw], certify=True)

    assert (told.outcome, told.twin) == (RehearsalOutcome.FAILED, "model")
    assert told.error.cause is RehearsalCause.LIMIT
    assert told.error.where.startswith("panda")
    assert told.certificate is None
    assert real.arm.state.q == before


def test_arm_that_moves_is_not_rehearsed_on(real):
    request = goal(POSITION, moved(j1=-0.2), 1.0)[0]["request"]
    real.facade.motion.submit_goal(POSITION, request)
    real.step(300)
    with pytest.raises(RehearsalError, match=f"A goal of '{POSITION}'") as refused:
        real.rehearsals.rehearse(goal(POSITION, moved(), 1.0))
    assert "stands still" in refused.value.remedy

    # Aborted, and the arm brakes.
    real.facade.stop("test")
    real.step(20)
    with pytest.raises(RehearsalError, match="panda_joint1 moves"):
        real.rehearsals.rehearse(goal(POSITION, moved(), 1.0))


def test_arm_with_an_error_is_not_rehearsed_on(real):
    real.arm.simulation().set_user_stop(pressed=True)
    real.step(200)
    with pytest.raises(RehearsalError, match="user_stopped"):
        real.rehearsals.rehearse(goal(POSITION, moved(), 1.0))


def test_model_has_the_load_the_gains_and_the_controllers_of_now(real):
    pid = {"p": 100.0, "i": 0.0, "d": 5.0}
    kind, joint = "effort_controllers/JointPositionController", "panda_joint7"
    params = {"type": kind, "joint": joint, "pid": pid}
    real.facade.switch_controllers(SwitchRequest(stop=[POSITION]))
    real.step(200)
    real.facade.load_controller(TUNED, params=params)
    (name,) = (k for k in real.facade.tuning.gains(TUNED).values if k.endswith("p"))
    real.facade.tuning.set_gains(TUNED, {name: 77.0})
    services = real.facade.robots.get("panda", FrankaServices)
    services.set_load(0.4, [0.0, 0.0, 0.05], [1e-3, 0, 0, 0, 1e-3, 0, 0, 0, 1e-3])
    real.step()
    real.facade.stop("by hand")
    real.step()

    twin = Likeness.of(real.config, real.facade).build()

    assert twin.loop.hw.arm.state.m_load == 0.4
    assert twin.tuning.gains(TUNED).values[name] == 77.0
    assert [c.name for c in twin.controllers()] == [POSITION, EFFORTS, TUNED]
    assert twin.status().stop_reason == "by hand"


def test_the_model_has_the_chains_of_the_station(real):
    joint = "panda_joint1"
    pid = {
        "type": "pid_controller/PidController",
        "dof_names": [joint],
        "command_interface": "effort",
        "reference_and_state_interfaces": ["position"],
        "gains": {joint: {"p": 1.0}},
    }
    upper = {"type": "position_controllers/JointGroupPositionController"}
    real.facade.load_controller("lower", params=pid)
    real.facade.load_controller("upper", params={**upper, "joints": [f"lower/{joint}"]})

    model = Likeness.of(real.config, real.facade).build()

    listed = [one.name for one in model.controllers()]
    assert listed == [one.name for one in real.facade.controllers()]
    assert listed.index("upper") < listed.index("lower")
