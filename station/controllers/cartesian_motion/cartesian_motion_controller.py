"""The base of the controllers that move an end effector smoothly."""

from collections.abc import Callable, Mapping
from typing import Any, ClassVar

from typing_extensions import override

from station.controllers.cartesian_motion.cartesian_limits import (
    LIMIT_PARAMETERS,
    CartesianLimits,
    read_cartesian_limits,
)
from station.controllers.cartesian_motion.cartesian_motion_generator import (
    CartesianMotionGenerator,
)
from station.controllers.cartesian_motion.end_effector_sample import (
    EndEffectorSample,
)
from station.controllers.cartesian_motion.joint_lookahead import (
    LOOKAHEAD_PARAMETERS,
    JointLookahead,
    Obstacle,
    read_lookahead_settings,
)
from station.controllers.franka_arm import (
    ARM_ID,
    JOINT_NAMES,
    find_model,
    read_arm_id,
    read_arm_joints,
)
from station.core.control.controller import MultiInterfaceController, require_interface
from station.core.control.sample_columns import SampleColumns
from station.core.declared_parameter import DeclaredParameter
from station.core.description.robot_description import require_robot_description
from station.core.franka import (
    FrankaCartesianPoseHandle,
    FrankaModelHandle,
    FrankaModelInterface,
    FrankaPoseCartesianInterface,
)
from station.core.hardware.robot_hw import RobotHW
from station.core.parameters import Parameters
from station.core.ports.set_point import (
    ActiveSetPoint,
    SetPointPort,
    read_command_timeout,
    timeout_parameters,
)
from station.memory.direct_calls import call_directly
from station.memory.doubles import Doubles
from station.memory.vectors import copy_into

DEFAULT_TIMEOUT = 0.2
"""Default of `command_timeout` [s]."""
LONGEST_TIMEOUT = 1.0
"""Longest validity of a set-point [s], so that set-points must be repeated."""
# Time for which an obstacle is still published after it was found last [s]. An obstacle
# may be found in every second cycle only; without this the message would flicker.
_PUBLISHED_FOR = 0.1
_POSE = 16
_NONE = Obstacle.NONE
_TEXTS = {
    Obstacle.NONE: "",
    Obstacle.JOINT_LIMIT: "{joint} is near its position limit; the arm waits there.",
    Obstacle.SINGULARITY: "A singular pose is near; the arm waits there.",
    Obstacle.SELF_COLLISION: "Two parts of the arm are close; the arm waits there.",
    Obstacle.JOINT_SPEED: "{joint} would be too fast; the arm goes more slowly.",
}


class EndEffectorUpdate:
    """The update of a controller that moves an end effector.

    Args:
        active: The set-point in force.
        steer: See `CartesianMotionController.steer`.
        generator: Generates the poses.
        lookahead: Says whether the joints can follow them.
        sample: Sample of the last cycle.
        command: The robot's storage of the commanded pose, 16 numbers.

    Attributes:
        is_resting: Whether the end effector rests, and nothing but rest is wanted;
            nothing is moved then, as long as the set-point in force stays.
        steered: The set-point that is the generator's target; None if `steer` has to be
            called again.
        obstacle: Published reason why the motion does not go on.
        joint: Name of the joint at the obstacle; None if there is none.
    """

    def __init__(
        self,
        active: ActiveSetPoint,
        steer: Callable[[list[float]], bool],
        generator: CartesianMotionGenerator,
        lookahead: JointLookahead,
        sample: EndEffectorSample,
        command: Doubles,
    ) -> None:
        self.active = active
        self.steer = steer
        self.generator = generator
        self.lookahead = lookahead
        self.sample = sample
        self.pose, self.command = generator.pose, command
        self.start(0.0)

    def start(self, time: float) -> None:
        """Forget the motion before.

        Args:
            time: Station time [s].
        """
        self.is_resting = False
        self.steered: list[float] | None = None
        self.obstacle, self.until = _NONE, time
        self.joint: str | None = None

    def move_end_effector(self, time: float, period: float) -> None:
        """Move the end effector, and keep the sample.

        Args:
            time: Station time of the cycle [s].
            period: Time since the last cycle [s], >= 0.

        Raises:
            CommandTimeoutError: The set-point has expired and the action is `stop`.
        """
        if not self.is_resting or self.active.port.has_changed():
            set_point, generator = self.active.newest(), self.generator
            if set_point is not self.steered:
                self.steered = set_point if self.steer(set_point) else None
            if generator.is_still():
                self.note(_NONE, None, time)
            else:
                self.advance(time, period)
                copy_into(self.command, 0, self.pose, _POSE)
            # While an obstacle is published, the next cycles have to end that.
            self.is_resting = generator.is_still() and self.obstacle is _NONE
        self.sample.keep(time)

    def advance(self, time: float, period: float) -> None:
        """Advance the motion if the joints can follow, else brake."""
        generator, lookahead = self.generator, self.lookahead
        motion = generator.motion
        generator.advance(period)
        if period == 0.0 or lookahead.passes(motion) or motion.is_at_rest():
            self.note(_NONE, None, time)
            return
        can_rest = lookahead.allows(motion)
        self.note(lookahead.obstacle, lookahead.joint, time)
        if not can_rest or not motion.stays_within_speed():
            # Braking from the previous state was found possible in the previous cycle.
            generator.undo()
            generator.brake()
            self.steered = None
            generator.advance(period)

    def note(self, obstacle: Obstacle, joint: str | None, time: float) -> None:
        """Note the obstacle found at a time [s], and publish it for a while."""
        if obstacle is not _NONE:
            self.obstacle, self.joint = obstacle, joint
            self.until = time + _PUBLISHED_FOR
        elif time > self.until:
            self.obstacle, self.joint = _NONE, None


class CartesianMotionController(MultiInterfaceController):
    """Moves an end effector within limits of velocity, acceleration and jerk.

    When the controller starts, and when no set-point arrives in time, the end effector
    comes to rest within the limits and holds. It also comes to rest before the joints
    would reach a limit, a singular pose or a collision of the arm with itself;
    `published` then names the obstacle, and the motion continues when the set-point
    leads elsewhere. A subclass defines the meaning of a set-point.

    Parameters: `arm_id`; `joint_names`, 7 names; see `read_cartesian_limits`,
    `read_lookahead_settings`; `command_timeout` [s], 0.2, at most 1.0;
    `command_timeout_action`, `hold` or `stop`. `robot_description` in this or an outer
    namespace gives the limits of the joints.
    """

    sampled: SampleColumns
    cycle_sample: EndEffectorSample
    required_interfaces: ClassVar[tuple[type, ...]] = (
        FrankaPoseCartesianInterface,
        FrankaModelInterface,
    )

    @classmethod
    @override
    def declared_parameters(cls) -> tuple[DeclaredParameter, ...]:
        return (
            *super().declared_parameters(),
            ARM_ID,
            JOINT_NAMES,
            *LIMIT_PARAMETERS,
            *LOOKAHEAD_PARAMETERS,
            *timeout_parameters(DEFAULT_TIMEOUT, longest=LONGEST_TIMEOUT),
        )

    @override
    def init(self, hw: RobotHW, params: Parameters) -> None:
        arm_id, names = read_arm_id(params), read_arm_joints(params)
        poses = require_interface(hw, FrankaPoseCartesianInterface)
        description = require_robot_description(params)
        self.handle: FrankaCartesianPoseHandle = poses.get_handle(f"{arm_id}_robot")
        self.model: FrankaModelHandle = find_model(hw, arm_id)
        self.limits = read_cartesian_limits(params)
        self.generator = CartesianMotionGenerator(self.limits)
        self.lookahead = JointLookahead(
            self.model,
            [description.joint(name) for name in names],
            read_lookahead_settings(params),
        )
        timeout, action = read_command_timeout(
            params, DEFAULT_TIMEOUT, longest=LONGEST_TIMEOUT
        )
        self.set_points = self.make_port(self.limits, timeout)
        self.joint_names = [element.name for element in self.set_points.elements]
        self._active = ActiveSetPoint(self.set_points, action, arm_id, self.rest)
        self.cycle_sample = self.make_sample()
        self.sampled = self.cycle_sample.sampled
        # Every slot of the handle is in the memory of the commanded pose.
        command: Any = self.handle.command_slots()[0][0]
        self._update = EndEffectorUpdate(
            self._active,
            self.steer,
            self.generator,
            self.lookahead,
            self.cycle_sample,
            command,
        )
        move = self._update.move_end_effector
        call_directly(self, CartesianMotionController, update=move)

    @property
    def is_free(self) -> bool:
        """Return whether `published` names no obstacle."""
        return self._update.obstacle is Obstacle.NONE

    def make_port(self, limits: CartesianLimits, timeout: float) -> SetPointPort:
        """Return the port that receives the set-points.

        Args:
            limits: Limits of the motion.
            timeout: How long a set-point is valid [s].
        """
        raise NotImplementedError

    def rest(self) -> list[float]:
        """Return the set-point at which the end effector rests."""
        raise NotImplementedError

    def steer(self, set_point: list[float]) -> bool:
        """Set the target of the generator in this cycle.

        Args:
            set_point: The set-point in force.

        Returns:
            Whether the target stays the same as long as the set-point does: then
            `steer` is called again only after the motion had to brake.
        """
        raise NotImplementedError

    def make_sample(self) -> EndEffectorSample:
        """Return the sample of a cycle, in the coordinates of the set-point."""
        raise NotImplementedError

    @override
    def starting(self, time: float) -> None:
        """Start at the desired pose of the end effector."""
        state = self.handle.get_robot_state()
        self.generator.start(state.O_T_EE_d)
        self.lookahead.start(state)
        self.handle.set_command(self.generator.pose)
        self._update.start(time)
        self._active.start_at_rest()

    @override
    def update(self, time: float, period: float) -> None:
        self._update.move_end_effector(time, period)

    @override
    def published(self) -> Mapping[str, Mapping[str, object]]:
        """Return the topic `state`: the obstacle, its joint, and a message."""
        obstacle, joint = self._update.obstacle, self._update.joint
        return {
            "state": {
                "obstacle": obstacle.value,
                "joint": joint or "",
                "message": _TEXTS[obstacle].format(joint=joint),
            }
        }
