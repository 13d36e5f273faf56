"""A model of a real arm: the simulated arm with the same configuration and settings."""

from collections.abc import Callable
from typing import TYPE_CHECKING

from station.app.composition import ROBOT_NAMESPACE, compose
from station.config.models import RobotSection
from station.core.clock import ManualClock
from station.core.control.controller import ControllerState
from station.core.control.switching import SwitchRequest
from station.core.errors import RehearsalError
from station.core.loop.stop_latch import StopState
from station.hw.franka.arm.load import Load
from station.hw.franka.franka_hw import FrankaHW

if TYPE_CHECKING:
    from station.config import StationConfig
    from station.core.facade.station import Station

_ADDRESS = "robot_ip"
_READY = frozenset({"idle", "move"})
"""Modes in which an arm moves, or may be started."""


def make_twin(
    config: "StationConfig", station: "Station", tell: Callable[[], None]
) -> "Station":
    """Return a stepped station with a simulated arm in the place of the real one.

    It stands where the real arm stands, with the same load, frames, thresholds, roles
    of the scene, controllers, gains and stop. Set-points in force are not taken over:
    controllers begin as after a switch.

    Args:
        config: The configuration.
        station: The station of the real arm; no cycle of it runs meanwhile.
        tell: Called after each piece of work.

    Raises:
        RehearsalError: The robot is no single real Franka arm, or is not ready.
        StationError: The simulated arm cannot stand or be set up like the real one.
    """
    real = station.loop.hw
    told = station.parameters.get(ROBOT_NAMESPACE)
    # Any other robot might connect to the real one again without an address.
    if not isinstance(real, FrankaHW) or not isinstance(told, dict):
        raise RehearsalError(
            "There is no model of this real robot.",
            remedy="Rehearse on a simulated station with the same configuration.",
        )
    if real.mode() not in _READY:
        raise RehearsalError(
            f"The arm is in the mode '{real.mode()}', which its model does not know.",
            remedy="Recover the arm, and rehearse again.",
        )
    section = {key: value for key, value in told.items() if key != _ADDRESS}
    changes = {"robot": RobotSection.model_validate(section), "controllers": {}}
    bare = config.model_copy(update={**changes, "start": [], "ros_controllers": []})
    twin = compose(bare, ManualClock(), announce=lambda _: tell()).station
    twin.manager.pump = lambda: twin.loop.step(1, twin.loop.period)
    if twin.joint_names != station.joint_names:
        raise RehearsalError(
            "The model has other joints than the real robot.",
            remedy="Set robot.fingers_in_joint_states to false.",
        )
    twin.loop.step(1, twin.loop.period)
    now = station.latest()
    here = dict(zip(station.joint_names, now.position, strict=True))
    twin.simulation.reset(here)
    if isinstance(twin.loop.hw, FrankaHW):
        _take_settings(real, twin.loop.hw)
    twin.surroundings.replace_roles(station.surroundings.entries())
    _take_controllers(station, twin, tell)
    latch = station.loop.stop_latch
    if latch.state is not StopState.ARMED:
        twin.stop(latch.reason)
    return twin


def _take_settings(real: FrankaHW, model: FrankaHW) -> None:
    """Let a simulated arm have the load, the frames and the thresholds of the real."""
    state, arm = real.arm.state, model.arm
    arm.set_load(Load(state.m_load, (*state.F_x_Cload,), (*state.I_load,)))
    arm.set_end_effector_frame(state.NE_T_EE)
    arm.set_stiffness_frame(state.EE_T_K)
    # None where the arm does not tell them: those of the configuration hold.
    behavior = real.arm.collision_behavior()
    if behavior is not None:
        arm.set_collision_behavior(behavior)


def _take_controllers(
    station: "Station", twin: "Station", tell: Callable[[], None]
) -> None:
    """Load the controllers of a station, set their gains, and start those that run."""
    running = []
    for one in station.controllers():
        params = station.parameters.get(one.name)
        if one.state is ControllerState.LOADING or not isinstance(params, dict):
            continue
        twin.load_controller(one.name, params=params)
        tell()
        if one.state is ControllerState.RUNNING:
            running.append(one.name)
    twin.tuning.set_many(station.tuning.all_gains())
    if running:
        twin.switch_controllers(SwitchRequest(start=running))
