"""The motion of an arm's end effector: its state, and its steps along poses and twists.

Six coordinates of the end effector do not determine the motion of seven joints. The
position of joint 3, the elbow, is therefore given, too, which makes the motion unique.

Source: Franka Control Interface documentation, Cartesian motion generators; differs:
the inverse kinematics of the arm is not public; here it is a Newton step per cycle with
the position of joint 3 as the seventh coordinate.
"""

from collections.abc import Callable

from station.core.franka.joint_memory import JointMemory
from station.core.numerics.arm_chain import (
    WrenchEquation,
    new_links,
    place_links,
    torques_of,
    twist_of,
    zero_jacobian,
)
from station.core.numerics.command_rates import limited
from station.core.numerics.rigid_motion import compose, displace, twist_between
from station.hw.franka.simulated.motion_check import MotionCheck
from station.hw.franka.simulated.violations import (
    ELBOW_SIGN,
    ELBOW_START,
    INVALID_FRAME,
    POSE_START,
    SOLVED_POSITION,
)
from station.memory.doubles import Doubles, own, zeros
from station.memory.functions import square_root
from station.memory.vectors import copy_into

START_TRANSLATION_TOLERANCE = 0.005
"""Largest distance of a first pose from O_T_EE_d [m]; not published."""
START_ROTATION_TOLERANCE = 0.01
"""Largest angle between a first pose and O_T_EE_d [rad]; not published."""
START_ELBOW_TOLERANCE = 0.01
"""Largest distance of a first elbow position from elbow_d [rad]; not published."""
MAX_EXTENSION = -0.467002423653011
"""Position of joint 4 at which the arm is extended farthest [rad]."""
_EXTENSION = MAX_EXTENSION
# Largest deviation from 1 of the length of a row or a column of a rotation.
_UNIT_TOLERANCE = 1e-5
# Count of the numbers in a twist; a command of any other size is a pose.
_TWIST_SIZE = 6
# Values below which the motion has ended: change of a joint in a cycle [rad]; velocity
# [m/s, rad/s] and acceleration [m/s^2, rad/s^2] of end effector and elbow.
_STILL_STEP = 1e-12
_STILL_VELOCITY = 1e-9
_STILL_ACCELERATION = 1e-6
# Damping of a step, relative to the matrix: one for full accuracy, and one for poses
# near a singularity, where an undamped step would be too large.
FINE_DAMPING = 1e-9
_COARSE_DAMPING = 1e-3
# Largest step of a joint [rad], 50 rad/s at 1 kHz; a larger one shows a singularity.
_LARGEST_STEP = 0.05


def is_transform(pose: Doubles) -> bool:
    """Return whether 16 finite numbers are a homogeneous transform, column-major.

    Orthogonality and handedness are not tested.

    Source: libfranka@0.9.2 src/control_tools.cpp, isHomogeneousTransformation.
    """
    if pose[3] != 0.0 or pose[7] != 0.0 or pose[11] != 0.0 or pose[15] != 1.0:
        return False
    for i in range(3):
        x, y, z = pose[4 * i], pose[4 * i + 1], pose[4 * i + 2]
        away = square_root(x * x + y * y + z * z) - 1.0
        if not -_UNIT_TOLERANCE <= away <= _UNIT_TOLERANCE:
            return False
        x, y, z = pose[i], pose[i + 4], pose[i + 8]
        away = square_root(x * x + y * y + z * z) - 1.0
        if not -_UNIT_TOLERANCE <= away <= _UNIT_TOLERANCE:
            return False
    return True


class EndEffectorState:
    """Pose, twist and elbow of an arm, measured, desired and commanded.

    Args:
        fields: Returns the memory of a field of the arm's state by libfranka's name;
            the memory is kept.
        chain: The arm's chain of n joints, see `arm_chain`.
    """

    def __init__(self, fields: Callable[[str], Doubles], chain: Doubles) -> None:
        links = new_links(chain)
        joints = len(chain) // 4 - 1
        self.chain = chain
        self.links = links
        self.flange = links[16 * joints :]
        self.jacobian = zeros(6 * joints)
        self.q = fields("q")
        self.q_d = fields("q_d")
        self.dq_d = fields("dq_d")
        self.ddq_d = fields("ddq_d")
        self.tool = fields("F_T_EE")
        self.pose = fields("O_T_EE")
        self.pose_d = fields("O_T_EE_d")
        self.pose_c = fields("O_T_EE_c")
        self.twist_d = fields("O_dP_EE_d")
        self.twist_c = fields("O_dP_EE_c")
        self.rate_c = fields("O_ddP_EE_c")
        self.elbow = fields("elbow")
        self.elbow_d = fields("elbow_d")
        self.elbow_c = fields("elbow_c")
        self.delbow_c = fields("delbow_c")
        self.ddelbow_c = fields("ddelbow_c")

    def refresh(self) -> None:
        """Update the measured and the desired fields."""
        place_links(self.chain, self.q, self.links)
        compose(self.flange, self.tool, self.pose)
        place_links(self.chain, self.q_d, self.links)
        compose(self.flange, self.tool, self.pose_d)
        zero_jacobian(self.links, self.pose_d, self.jacobian)
        twist_of(self.jacobian, self.dq_d, self.twist_d)
        bend(self.q, self.elbow)
        bend(self.q_d, self.elbow_d)

    def command_desired(self) -> None:
        """Set the commanded fields to the desired ones, which must be up to date."""
        for i in range(16):
            self.pose_c[i] = self.pose_d[i]
        for i in range(6):
            self.twist_c[i] = self.twist_d[i]
            self.rate_c[i] = 0.0
        self.elbow_c[0], self.elbow_c[1] = self.elbow_d[0], self.elbow_d[1]
        self.delbow_c[0], self.delbow_c[1] = self.dq_d[2], 0.0
        self.ddelbow_c[0], self.ddelbow_c[1] = self.ddq_d[2], 0.0

    def command_joint_motion(self) -> None:
        """Make the desired joint motion the commanded motion of the end effector."""
        self.refresh()
        self.command_desired()
        twist_of(self.jacobian, self.ddq_d, self.rate_c)


def bend(q: Doubles, result: Doubles) -> None:
    """Write an elbow: position of joint 3 [rad], and sign of joint 4's flip.

    Args:
        q: Joint positions [rad], shape (n,).
        result: Receives the elbow, shape (2,).
    """
    flip = q[3] - _EXTENSION
    result[0] = q[2]
    result[1] = 1.0 if flip > 0.0 else -1.0 if flip < 0.0 else 0.0


class InverseKinematics:
    """Newton steps of the joints towards a pose; arrays are kept and not copied.

    Args:
        chain: The chain of n joints, see `arm_chain`.
        q: Joint positions [rad], shape (n,).
        tool: End effector in the flange frame, 16 numbers.
        target: Pose to reach, 16 numbers.
        step: Receives a step [rad], shape (n,).
    """

    def __init__(
        self, chain: Doubles, q: Doubles, tool: Doubles, target: Doubles, step: Doubles
    ) -> None:
        size = len(q)
        self.chain = own(chain)
        self.q = q
        self.tool = tool
        self.target = target
        self.step = step
        self.links = own(new_links(chain))
        self.end = 16 * size
        self.flange, self.pose = own([0.0] * 16), own([0.0] * 16)
        self.jacobian = own([0.0] * (6 * size))
        self.error, self.wrench = own([0.0] * 6), own([0.0] * 6)
        self.equation = WrenchEquation()

    def advance(self, elbow: float) -> None:
        """Write the step that leads to the target, with joint 3 at `elbow` [rad]."""
        step, jacobian, error = self.step, self.jacobian, self.error
        place_links(self.chain, self.q, self.links)
        copy_into(self.flange, 0, self.links[self.end :], 16)
        compose(self.flange, self.tool, self.pose)
        zero_jacobian(self.links, self.pose, jacobian)
        twist_between(self.pose, self.target, 1.0, error)
        bend = elbow - self.q[2]
        # Joint 3 has its position already: remove its column from the equation, and its
        # part from the error.
        for k in range(12, 18):
            error[k - 12] -= bend * jacobian[k]
            jacobian[k] = 0.0
        self.solve(FINE_DAMPING)
        largest = _LARGEST_STEP
        lowest = -largest
        for joint in range(len(step)):
            if not lowest < step[joint] < largest:
                self.solve(_COARSE_DAMPING)
                break
        step[2] = bend

    def solve(self, damping: float) -> None:
        """Write the smallest motion of the joints that corrects the error."""
        if self.equation.factorise(self.jacobian, damping):
            self.equation.solve(self.error, self.wrench)
            torques_of(self.jacobian, self.wrench, self.step)
        else:
            for joint in range(len(self.step)):
                self.step[joint] = 0.0


class CartesianStep:
    """The motion of an arm's end effector, one cycle at a time.

    Args:
        memory: State and commands of the joints.
        check: Compares commanded motions with the limits.
        fields: Returns the memory of a field of the arm's state; the commanded pose,
            twist and elbow are those of the last cycle.
        chain: The arm's chain of n joints, see `arm_chain`.
        period: Duration of a cycle, > 0 [s].

    Attributes:
        command: The command of this cycle, a pose or a twist, shape (16,).
        size: Count of the numbers in the command.
        elbow_command: Position of joint 3 [rad] and sign of joint 4, shape (2,).
        has_elbow: Whether the command gives an elbow; if not, joint 3 comes to rest.
        next_pose: The next pose, 16 numbers.
        next_twist: The twist that leads to it [m/s, rad/s], shape (6,).
        next_elbow: Next position, velocity and acceleration of joint 3.
        is_settled: Whether the joints are at rest at the pose of the last cycle.
    """

    def __init__(
        self,
        memory: JointMemory,
        check: MotionCheck,
        fields: Callable[[str], Doubles],
        chain: Doubles,
        period: float,
    ) -> None:
        self.memory = memory
        self.check = check
        self.state = EndEffectorState(fields, chain)
        self.next_pose = zeros(16)
        # The solver leads from `q_d` to the next pose.
        self.kinematics = InverseKinematics(
            chain, memory.q_d, fields("F_T_EE"), self.next_pose, zeros(memory.size)
        )
        self.period = period
        self.command = zeros(16)
        self.size = 0
        self.elbow_command = zeros(2)
        self.has_elbow = False
        self.next_twist = zeros(6)
        self.next_elbow = zeros(3)
        self.is_settled = False

    def begin_motion(self) -> None:
        """Start from the pose and the velocity of the desired joint motion."""
        self.state.command_joint_motion()
        self.is_settled = False

    def follow_command(self, is_first: bool, may_settle: bool) -> int:  # noqa: FBT001
        """Follow the command: write the joints' next positions as their target.

        Args:
            is_first: Whether this is the first command of the motion.
            may_settle: Whether joints at rest may stay exactly where they are.

        Returns:
            Number of violations; if there are any, the joints must not move.
        """
        if may_settle and self.is_settled and self.repeats():
            copy_into(self.memory.target, 0, self.memory.q_d, self.memory.size)
            return 0
        count = self.plan(is_first)
        if count == 0:
            count = self.move_joints()
            if count == 0 and may_settle:
                self.is_settled = self.is_still()
        return count

    def extrapolate(self) -> int:
        """Continue with constant acceleration, because no command has arrived."""
        following, period, state = self.next_elbow, self.period, self.state
        for i in range(6):
            self.next_twist[i] = state.twist_c[i] + state.rate_c[i] * period
        displace(state.pose_c, self.next_twist, period, self.next_pose)
        following[2] = state.ddelbow_c[0]
        following[1] = state.delbow_c[0] + following[2] * period
        following[0] = state.elbow_c[0] + following[1] * period
        return self.move_joints()

    def repeats(self) -> bool:
        """Return whether the command is the pose of the last cycle."""
        if self.size == _TWIST_SIZE:
            return False
        for i in range(16):
            if self.command[i] != self.state.pose_c[i]:
                return False
        return True

    def is_still(self) -> bool:
        """Return whether nothing moves after the last step."""
        state, step = self.state, self.kinematics.step
        if not (
            -_STILL_VELOCITY < state.delbow_c[0] < _STILL_VELOCITY
            and -_STILL_ACCELERATION < state.ddelbow_c[0] < _STILL_ACCELERATION
        ):
            return False
        for i in range(6):
            if not (
                -_STILL_VELOCITY < state.twist_c[i] < _STILL_VELOCITY
                and -_STILL_ACCELERATION < state.rate_c[i] < _STILL_ACCELERATION
            ):
                return False
        for i in range(self.memory.size):
            if not -_STILL_STEP < step[i] < _STILL_STEP:
                return False
        return True

    def plan(self, is_first: bool) -> int:  # noqa: FBT001 - a C function
        """Compute the next pose, twist and elbow; return the number of violations.

        Args:
            is_first: Whether this is the first command of the motion.
        """
        command, check, state = self.command, self.check, self.state
        if self.size == _TWIST_SIZE:
            for i in range(6):
                self.next_twist[i] = command[i]
            displace(state.pose_c, self.next_twist, self.period, self.next_pose)
        elif not is_transform(command):
            check.violations.add(INVALID_FRAME, 0, 0.0, 0.0)
            return 1
        else:
            copy_into(self.next_pose, 0, command, 16)
            twist_between(state.pose_c, command, self.period, self.next_twist)
            # Only a pose can begin elsewhere: a twist begins at the end effector.
            if is_first and self.check_start():
                return check.violations.count
        if check.check_twist(self.next_twist, state.twist_c, state.rate_c):
            return check.violations.count
        if self.has_elbow:
            return self.plan_elbow(is_first)
        self.rest_elbow()
        return 0

    def check_start(self) -> int:
        """Compare the first pose of a motion with the present pose."""
        violations, twist = self.check.violations, self.next_twist
        for part in range(2):
            x, y, z = twist[3 * part], twist[3 * part + 1], twist[3 * part + 2]
            away = square_root(x * x + y * y + z * z) * self.period
            most = START_ROTATION_TOLERANCE if part else START_TRANSLATION_TOLERANCE
            if away > most:
                violations.add(POSE_START, part, away, most)
        return violations.count

    def plan_elbow(self, is_first: bool) -> int:  # noqa: FBT001 - a C function
        """Take the elbow from the command; return the number of violations.

        Args:
            is_first: Whether this is the first command of the motion.
        """
        command, state, check = self.elbow_command, self.state, self.check
        sign, period, following = state.elbow_c[1], self.period, self.next_elbow
        if command[1] != sign:
            check.violations.add(ELBOW_SIGN, 0, command[1], sign)
            return 1
        away = command[0] - state.elbow_c[0]
        if is_first and abs(away) > START_ELBOW_TOLERANCE:
            check.violations.add(ELBOW_START, 0, abs(away), START_ELBOW_TOLERANCE)
            return 1
        rate = away / period
        acceleration = (rate - state.delbow_c[0]) / period
        jerk = (acceleration - state.ddelbow_c[0]) / period
        following[0], following[1], following[2] = command[0], rate, acceleration
        return check.check_elbow(rate, acceleration, jerk)

    def rest_elbow(self) -> None:
        """Let joint 3 come to rest: the arm's choice without an elbow command."""
        bounds, following, period = self.check.elbow, self.next_elbow, self.period
        speed, last = self.state.delbow_c[0], self.state.ddelbow_c[0]
        rate = limited(
            0.0, speed, last, bounds[1], bounds[2], -bounds[0], bounds[0], period
        )
        following[0] = self.state.elbow_c[0] + rate * period
        following[1] = rate
        following[2] = (rate - speed) / period

    def move_joints(self) -> int:
        """Take over the next pose; write the joints' positions that reach it.

        Returns:
            Number of limits of the joints that are violated.
        """
        memory, kinematics, state = self.memory, self.kinematics, self.state
        twist, rates, new = state.twist_c, state.rate_c, self.next_twist
        following, period, step = self.next_elbow, self.period, kinematics.step
        for i in range(6):
            rates[i] = (new[i] - twist[i]) / period
            twist[i] = new[i]
        copy_into(state.pose_c, 0, self.next_pose, 16)
        state.elbow_c[0] = following[0]
        state.delbow_c[0] = following[1]
        state.ddelbow_c[0] = following[2]
        self.is_settled = False
        kinematics.advance(following[0])
        for i in range(memory.size):
            memory.target[i] = memory.q_d[i] + step[i]
        return self.check.check_positions(SOLVED_POSITION)
