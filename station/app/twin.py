"""A model of a real arm: a simulated arm with its settings, in a separate process.

For a simulated arm the station's process is copied. With a real arm, this may delay the
control thread for so long that the arm misses too many commands and stops. A spawned
process shares no memory with the station, and does not delay it.
"""

import logging
import os
import pickle
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import TypeVar

from station.app.composition import ROBOT_NAMESPACE, compose
from station.config import StationConfig
from station.config.models import RobotSection
from station.core.clock import ManualClock
from station.core.control.chains import depth_of
from station.core.control.controller import ControllerState
from station.core.control.switching import SwitchRequest
from station.core.errors import RehearsalError, StationError
from station.core.facade.station import Station
from station.core.franka import CollisionBehavior
from station.core.loop.stop_latch import StopState
from station.hw.franka.arm.rigid_body import RigidBody
from station.hw.franka.franka_hw import FrankaHW

ResultT = TypeVar("ResultT")

_READY = frozenset({"idle", "move"})
"""Modes in which an arm moves or can begin to move."""
_LONGEST = 60.0
"""Longest run of a model [s]: one or two seconds to start, and the motion."""


@dataclass(frozen=True, slots=True)
class Likeness:
    """The settings and the state that a model takes from the real arm.

    Attributes:
        config: The configuration, without controllers and without the address of the
            arm.
        positions: Positions of the joints by name [rad].
        load: RigidBody that is set in the arm.
        end_effector: NE_T_EE, column-major, shape (16,).
        stiffness_frame: EE_T_K, column-major, shape (16,).
        behavior: Collision thresholds that are set in the arm; None for those of the
            configuration.
        roles: The objects with a role around the arm.
        controllers: Parameters of the loaded controllers, by name.
        running: Names of the running controllers.
        gains: Gains by controller and name.
        stopped: Reason of the latched stop; None if motion is allowed.
    """

    config: StationConfig
    positions: Mapping[str, float]
    load: RigidBody
    end_effector: tuple[float, ...]
    stiffness_frame: tuple[float, ...]
    behavior: CollisionBehavior | None
    roles: Sequence[Mapping[str, object]]
    controllers: Mapping[str, Mapping[str, object]]
    running: Sequence[str]
    gains: Mapping[str, Mapping[str, float]]
    stopped: str | None

    @classmethod
    def of(cls, config: StationConfig, station: Station) -> "Likeness":
        """Read the settings and the state of a station's real arm.

        Args:
            config: Its configuration.
            station: The station.

        Raises:
            RehearsalError: The robot is not a single real Franka arm, or the arm is not
                ready.
        """
        real, given = station.loop.hw, station.parameters.get(ROBOT_NAMESPACE)
        # Only for this class is it known that a robot without an address is simulated.
        if not isinstance(real, FrankaHW) or not isinstance(given, dict):
            raise RehearsalError(
                "There is no model of this real robot.",
                remedy="Rehearse on a simulated station with the same configuration.",
            )
        if real.mode() not in _READY:
            raise RehearsalError(
                f"The arm is in the mode '{real.mode()}', which its model has not.",
                remedy="Recover the arm, and rehearse again.",
            )
        section = {key: value for key, value in given.items() if key != "robot_ip"}
        robot = RobotSection.model_validate(section)
        bare: dict[str, object] = {
            "controllers": {},
            "start": [],
            "ros_controllers": [],
        }
        # A controller is loaded after those that it commands, and listed before them.
        depths = {o.info.name: depth_of(o) for o in station.manager.lifecycle.loaded}
        listed = sorted(station.controllers(), key=lambda s: depths.get(s.name, 0))
        found = {one.name: station.parameters.get(one.name) for one in listed}
        latch, state = station.loop.stop_latch, real.arm.state
        now = station.latest().position
        return cls(
            config.model_copy(update={"robot": robot, **bare}),
            dict(zip(station.joint_names, now, strict=True)),
            RigidBody(state.m_load, (*state.F_x_Cload,), (*state.I_load,)),
            (*state.NE_T_EE,),
            (*state.EE_T_K,),
            real.arm.collision_behavior(),
            station.surroundings.entries(),
            {
                one.name: params
                for one in listed
                if one.state is not ControllerState.LOADING
                and isinstance(params := found[one.name], dict)
            },
            [one.name for one in listed if one.state is ControllerState.RUNNING],
            station.tuning.all_gains(),
            None if latch.state is StopState.ARMED else latch.reason,
        )

    def build(self) -> Station:
        """Return a stepped station with a simulated arm of these settings.

        Raises:
            RehearsalError: The simulated arm has other joints.
            StationError: The simulated arm cannot take over the pose or a setting of
                the real one.
        """
        twin = compose(self.config, ManualClock()).station
        hw, period = twin.loop.hw, twin.loop.period
        twin.manager.pump = lambda: twin.loop.step(1, period)
        if twin.joint_names != [*self.positions] or not isinstance(hw, FrankaHW):
            raise RehearsalError(
                "The model has other joints than the real robot.",
                remedy="Set robot.fingers_in_joint_states to false.",
            )
        twin.loop.step(1, period)
        twin.simulation.reset(self.positions)
        hw.arm.set_load(self.load)
        hw.arm.set_end_effector_frame(self.end_effector)
        hw.arm.set_stiffness_frame(self.stiffness_frame)
        if self.behavior is not None:
            hw.arm.set_collision_behavior(self.behavior)
        twin.surroundings.replace_roles(self.roles)
        for name, params in self.controllers.items():
            twin.load_controller(name, params=params)
        twin.tuning.set_many(self.gains)
        if self.running:
            twin.switch_controllers(SwitchRequest(start=self.running))
        if self.stopped is not None:
            twin.stop(self.stopped)
        return twin


def run_model(
    config: StationConfig, station: Station, work: Callable[[Station], ResultT]
) -> ResultT:
    """Call a function with a model of a real arm, and return its result.

    Args:
        config: The configuration of the station.
        station: The station.
        work: Function that is called with the model, in a separate process.

    Raises:
        RehearsalError: The arm has no model, or the process ended without a result.
        StationError: `work` has raised it.
    """
    question = pickle.dumps((Likeness.of(config, station), work))
    # Without `close_fds` the process is spawned, so that no memory of this one is
    # copied.
    with subprocess.Popen(
        [sys.executable, "-m", "station.app.twin"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        close_fds=False,
    ) as process:
        try:
            answer, trace = process.communicate(question, _LONGEST)
        except subprocess.TimeoutExpired as late:
            process.kill()
            raise RehearsalError(
                f"The model came to no result in {_LONGEST:g} s.",
                remedy="Rehearse a shorter motion, or plan with less time.",
            ) from late
    if process.returncode != 0:
        raise RehearsalError(
            "The process of the model failed.",
            remedy="Report it: the details have the traceback.",
            details={"traceback": trace.decode(errors="replace")},
        )
    found: ResultT | StationError = pickle.loads(answer)
    if isinstance(found, StationError):
        raise found
    return found


def _answer(question: bytes) -> object:
    """Call the function in a request; return its result, or the error it raised."""
    likeness, work = pickle.loads(question)
    try:
        return work(likeness.build())
    except StationError as error:
        return error


if __name__ == "__main__":
    with suppress(OSError):
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
    # The station has already logged the warnings that building it again would log.
    logging.disable()
    sys.stdout.buffer.write(pickle.dumps(_answer(sys.stdin.buffer.read())))
