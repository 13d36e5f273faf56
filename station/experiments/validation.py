"""Check a robot against its description, and make a page of the results."""

import copy
import html
import platform
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Literal

import mujoco
import numpy as np

import station
from station.core.errors import StationError
from station.core.hardware.robot_report import JointLimitsReport
from station.experiments.trial_world import TrialWorld, small_motions
from station.trials.trial import Script, Setup, Trial
from station.wire.excitations import Waypoints

Outcome = Literal["passed", "failed", "skipped"]

IDLE_MOTION = 0.01
"""How far a joint without commands may move in a second [rad or m]."""
GOAL_ERROR = 0.02
"""How far from its goal a joint may end [rad or m]."""
ENERGY_DRIFT = 0.02
"""Largest change of energy in a second of free motion, as a share of the largest
kinetic energy."""
_MOVING_TIME = 1.5
_RESTING_TIME = 0.5


@dataclass(frozen=True, slots=True)
class Check:
    """One line of a scorecard.

    Attributes:
        name: Name of the check.
        outcome: `passed`, `failed`, or `skipped` when it does not apply.
        detail: Observation, in one sentence.
    """

    name: str
    outcome: Outcome
    detail: str


@dataclass(frozen=True, slots=True)
class Scorecard:
    """The results of a robot's checks.

    Attributes:
        robot: Name of the checked robot.
        setup: Digest of its setup.
        checks: The checks in their order.
    """

    robot: str
    setup: str
    checks: tuple[Check, ...]

    @property
    def is_good(self) -> bool:
        """Return whether no check failed."""
        return all(check.outcome != "failed" for check in self.checks)

    def to_html(self) -> str:
        """Return the scorecard as an HTML page that needs no scripts or other files."""
        rows = "\n".join(
            f'<tr class="{c.outcome}"><td>{html.escape(c.name)}</td>'
            f"<td>{c.outcome}</td><td>{html.escape(c.detail)}</td></tr>"
            for c in self.checks
        )
        failed = sum(check.outcome == "failed" for check in self.checks)
        verdict = "All checks passed." if not failed else f"{failed} checks failed."
        robot = html.escape(self.robot)
        return _PAGE.format(
            robot=robot,
            verdict=verdict,
            rows=rows,
            versions=html.escape(
                f"Setup {self.setup}, station {station.__version__}, MuJoCo "
                f"{mujoco.mj_versionString()}, Python {platform.python_version()}"
            ),
        )


_MOST_REPAIRS = 12
"""Most repairs of a description that a scorecard lists."""
_PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>Scorecard of {robot}</title>
<style>
body {{ font-family: sans-serif; margin: 2em auto; max-width: 60em; }}
table {{ border-collapse: collapse; width: 100%; }}
td, th {{ border-bottom: 1px solid #ccc; padding: 0.4em; text-align: left; }}
.passed td:nth-child(2) {{ color: #176117; }}
.failed td:nth-child(2) {{ color: #b00020; font-weight: bold; }}
.skipped {{ color: #666; }}
</style></head><body>
<h1>Scorecard of {robot}</h1>
<p>{verdict}</p>
<table><thead><tr><th>Check</th><th>Outcome</th><th>What was seen</th></tr></thead>
<tbody>
{rows}
</tbody></table>
<p>{versions}</p>
</body></html>
"""


def validate(setup: Setup, robot: str) -> Scorecard:
    """Return the scorecard of a robot and its controllers.

    Args:
        setup: The configuration.
        robot: Name in the scorecard.
    """
    try:
        world = TrialWorld(setup)
    except StationError as error:
        why = f"{error.message} {error.remedy}".strip()
        return Scorecard(robot, setup.digest, (Check("robot loads", "failed", why),))
    with world:
        checks = (
            Check("robot loads", "passed", _size(world)),
            _repairs(world),
            *_loading(world),
            _limits(world),
            _energy(world.model()),
            _at_rest(world),
            *(check for name in _moving(world) for check in _controller(world, name)),
        )
    return Scorecard(robot, setup.digest, checks)


def _size(world: TrialWorld) -> str:
    model = world.model()
    mass = float(np.sum(model.body_mass))
    return f"{len(world.station.joint_names)} joints, {mass:.3g} kg in all."


def _repairs(world: TrialWorld) -> Check:
    repairs = world.station.facade.loop.hw.repairs()
    sentences = "; ".join(one.sentence() for one in repairs[:_MOST_REPAIRS])
    if len(repairs) > _MOST_REPAIRS:
        sentences += f"; and {len(repairs) - _MOST_REPAIRS} more: see `station doctor`"
    return Check("description", "passed", f"Repaired: {sentences or 'nothing'}.")


def _loading(world: TrialWorld) -> Iterator[Check]:
    for controller in world.station.facade.controllers():
        name = f"controller {controller.name} loads"
        notes = " ".join([f"It is a {controller.type}.", *controller.notes])
        yield Check(name, "passed", notes)
    for missing, error in world.station.not_loaded.items():
        why = f"{error.message} {error.remedy}".strip()
        yield Check(f"controller {missing} loads", "failed", why)


def _limits(world: TrialWorld) -> Check:
    reports = world.station.facade.loop.hw.joint_limits()
    known = {report.joint for report in reports}
    without = [joint for joint in world.station.joint_names if joint not in known]
    # A joint without a motor cannot be commanded, e.g. one that mimics another joint.
    driven = [joint for joint in without if _has_motor(world.model(), joint)]
    problems = [f"{joint} has no limits" for joint in driven]
    problems += [problem for report in reports for problem in _gaps(report)]
    if problems:
        return Check("limits of joints", "failed", f"{'; '.join(problems)}.")
    idle = [joint for joint in without if joint not in driven]
    also = f" Without a motor: {', '.join(idle)}." if idle else ""
    return Check(
        "limits of joints", "passed", f"{len(reports)} joints have all limits.{also}"
    )


def _has_motor(model: mujoco.MjModel, joint: str) -> bool:
    number: int = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_ACTUATOR, joint)
    return number >= 0


def _gaps(report: JointLimitsReport) -> Iterator[str]:
    limits = report.limits
    if limits.max_velocity is None or limits.max_velocity <= 0.0:
        yield f"{report.joint} has no velocity limit"
    if limits.max_effort is None or limits.max_effort <= 0.0:
        yield f"{report.joint} has no effort limit"


def _energy(model: mujoco.MjModel) -> Check:
    """Check the energy of a copy that falls without motors, friction and contacts."""
    name = "energy of free motion"
    model = copy.deepcopy(model)
    model.dof_damping[:] = model.dof_frictionloss[:] = 0.0
    model.body_gravcomp[:] = model.jnt_stiffness[:] = 0.0
    model.opt.integrator = mujoco.mjtIntegrator.mjINT_RK4
    # Limits of joints would also take energy away.
    disabled = mujoco.mjtDisableBit
    model.opt.disableflags |= (
        disabled.mjDSBL_CONTACT | disabled.mjDSBL_LIMIT | disabled.mjDSBL_ACTUATION
    )
    model.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_ENERGY
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    begin, largest = float(data.energy.sum()), 0.0
    while data.time < 1.0:
        mujoco.mj_step(model, data)
        largest = max(largest, float(data.energy[1]))
    mujoco.mj_forward(model, data)
    if largest == 0.0:
        return Check(name, "skipped", "Nothing moves under gravity alone.")
    drift = abs(float(data.energy.sum()) - begin) / largest
    outcome: Outcome = "passed" if drift <= ENERGY_DRIFT else "failed"
    return Check(
        name,
        outcome,
        f"{drift:.2%} of {largest:.3g} J came or went in 1 s; allowed are "
        f"{ENERGY_DRIFT:.0%}.",
    )


def _at_rest(world: TrialWorld) -> Check:
    """Check that the robot stays at rest without a controller."""
    name = "holds its weight without a controller"
    robot = world.station
    world.put_back()
    robot.step()
    touching = _touching(world)
    before = np.array(robot.latest().position)
    robot.run(1.0)
    moved = np.abs(np.array(robot.latest().position) - before)
    worst = int(moved.argmax())
    outcome: Outcome = "passed" if moved[worst] <= IDLE_MOTION else "failed"
    return Check(
        name,
        outcome,
        f"{robot.joint_names[worst]} moved by {moved[worst]:.2g} in 1 s; allowed are "
        f"{IDLE_MOTION:g} rad or m.{touching if outcome == 'failed' else ''}",
    )


def _touching(world: TrialWorld) -> str:
    """Return a sentence about links that touch each other now; empty if none do."""
    model, data = world.model(), world.data()
    pairs = sorted({
        tuple(sorted(model.body(model.geom_bodyid[geom]).name for geom in contact.geom))
        for contact in data.contact
        if (contact.geom >= 0).all()
    })
    if not pairs:
        return ""
    shown = "; ".join(" and ".join(pair) for pair in pairs)
    return f" At its start these touch: {shown}. Choose other initial_positions."


def _moving(world: TrialWorld) -> list[str]:
    """Return the controllers that move joints."""
    manager = world.station.facade.manager
    return [
        status.name
        for status in world.station.facade.controllers()
        if manager.get_controller(status.name).set_points is not None
        or manager.get_controller(status.name).trajectories is not None
    ]


def _controller(world: TrialWorld, name: str) -> Iterator[Check]:
    yield _played(world, name, "keeps still", (), _keeps_still)
    motions = small_motions(world, name, (_MOVING_TIME,), (1.0,))
    if motions:
        yield _played(world, name, "reaches a goal", motions, _reaches)
    else:
        why = "It does not command positions of joints."
        yield Check(f"{name} reaches a goal", "skipped", why)


def _played(
    world: TrialWorld,
    name: str,
    what: str,
    motions: Sequence[Waypoints],
    judge: Callable[[np.ndarray, np.ndarray], tuple[float, float]],
) -> Check:
    """Run some motions and judge the displacements of all joints, shape (n,)."""
    duration = _MOVING_TIME + _RESTING_TIME
    script = Script(controller=name, duration=duration, commands=tuple(motions))
    result, trace = world.record(Trial(world.setup, script))
    title = f"{name} {what}"
    if trace is None or result.state == "failed":
        return Check(title, "failed", result.reason or "It did not run.")
    ways = trace.position[-1] - trace.position[0]
    wanted = {motion.joint: motion.values[-1] for motion in motions}
    goals = np.array([wanted.get(joint, 0.0) for joint in trace.joints])
    seen, allowed = judge(ways, goals)
    outcome: Outcome = "passed" if seen <= allowed else "failed"
    return Check(title, outcome, f"{seen:.2g} rad or m off; allowed are {allowed:g}.")


def _keeps_still(ways: np.ndarray, goals: np.ndarray) -> tuple[float, float]:
    return float(np.abs(ways - goals).max(initial=0.0)), IDLE_MOTION


def _reaches(ways: np.ndarray, goals: np.ndarray) -> tuple[float, float]:
    return float(np.abs(ways - goals).max(initial=0.0)), GOAL_ERROR
