"""Hold end effectors by springs to equilibrium poses, one for each arm.

    tau = J^T (-K e - D J dq) + (1 - J^T (J^T)^+) (k (q_n - q) - 2 sqrt(k) dq) + c

J is the Jacobian of the end effector and (J^T)^+ the pseudo-inverse of its transpose
with the damped singular values s / (s^2 + 0.2^2); e is the pose error; K is the
stiffness and D = 2 sqrt(K) the damping; q_n are the joint positions at the start, to
which a spring of stiffness k pulls in the null space; c are the Coriolis torques.
Stiffnesses and equilibrium approach their targets through a low-pass filter, because a
jump would make the torques jump.

The projection J^T (J^T)^+ is J^T (J J^T + 0.2^2)^-1 J, which needs no singular values.

Source: franka_ros@c11f000 franka_example_controllers,
src/cartesian_impedance_example_controller.cpp and
dual_arm_cartesian_impedance_example_controller.cpp, the part that both share; differs:
every start begins without stiffness, not only the first start, and with the null space
stiffness that is set.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from station.controllers.franka_arm.arm_handles import LARGEST_STEP
from station.core.franka import Frame, FrankaModelHandle, FrankaStateHandle
from station.core.hardware.interfaces import JointGroup
from station.core.numerics.arm_chain import WrenchEquation, torques_of, twist_of
from station.core.numerics.command_rates import filter_commands
from station.core.numerics.rigid_motion import quaternion_of
from station.core.ports.set_point import SetPointPort
from station.core.toolbox.publish_timer import PublishTimer
from station.memory.doubles import Doubles, put, zeros
from station.memory.functions import arctangent, sine, square_root
from station.memory.vectors import copy_into

# Share of the distance to a new target that is covered per cycle.
_FILTER = 0.005
_INVERSE_DAMPING = 0.2 * 0.2
# Cosine of half an angle above which turning evenly is as good as a straight line.
_CLOSE = 0.9995


class PoseSpring:
    """The torques of one spring; every array is kept and not copied.

    Args:
        q: Measured joint positions [rad], shape (n,).
        dq: Measured joint velocities [rad/s], shape (n,).
        last_torques: Torques commanded in the last cycle [Nm], shape (n,).
        largest_step: Largest change of a torque per cycle [Nm], > 0.
        is_angle: Whether the rotation error is a rotation vector; otherwise it is the
            vector part of a quaternion.

    Attributes:
        pose: Measured pose of the end effector in the base frame, 16 numbers; the
            caller brings it, `jacobian` and `coriolis` up to date.
        jacobian: Jacobian of the end effector in the axes of the base, 6 n numbers,
            column-major.
        coriolis: Coriolis torques [Nm], shape (n,).
        equilibrium: Position [m], then unit quaternion x y z w, shape (7,).
        target: Pose that the equilibrium approaches, shape (7,).
        stiffness: Against translations [N/m] and rotations [Nm/rad], and of the joints
            in the null space [Nm/rad], shape (3,), >= 0.
        wanted: Values that the stiffnesses approach, shape (3,), >= 0.
        torques: The torques [Nm], shape (n,).
    """

    def __init__(
        self,
        q: Doubles,
        dq: Doubles,
        last_torques: Doubles,
        largest_step: float,
        is_angle: bool,  # noqa: FBT001 - positional for the compiler
    ) -> None:
        size = len(q)
        self.size = size
        self.q = q
        self.dq = dq
        self.pose = zeros(16)
        self.last_torques = last_torques
        self.largest_step = largest_step
        self.is_angle = is_angle
        self.jacobian = zeros(6 * size)
        self.coriolis = zeros(size)
        self.torques = zeros(size)
        self.equilibrium = zeros(7)
        self.target = zeros(7)
        self.stiffness = zeros(3)
        self.wanted = zeros(3)
        self.damping = zeros(2)
        self.rest = zeros(size)
        self.stray = zeros(size)
        self.error = zeros(6)
        self.twist = zeros(6)
        self.wrench = zeros(6)
        self.quaternion = zeros(4)
        self.equation = WrenchEquation()

    def start_at_rest(self, nullspace: float) -> None:
        """Make the present pose the equilibrium, and start without stiffness.

        Args:
            nullspace: Stiffness of the null space from the start on [Nm/rad], >= 0.
        """
        quaternion_of(self.pose, self.quaternion)
        for k in range(3):
            self.equilibrium[k] = self.pose[12 + k]
        for k in range(4):
            self.equilibrium[3 + k] = self.quaternion[k]
        for k in range(7):
            self.target[k] = self.equilibrium[k]
        self.stiffness[0], self.stiffness[1], self.stiffness[2] = 0.0, 0.0, nullspace
        self.damping[0], self.damping[1] = 0.0, 0.0
        for joint in range(self.size):
            self.rest[joint] = self.q[joint]

    def compute_torques(self) -> None:
        """Write the torques of this cycle, then move on towards the targets."""
        # The pose error in the axes of the base, position [m] first.
        error, own, actual = self.error, self.equilibrium, self.quaternion
        for k in range(3):
            error[k] = self.pose[12 + k] - own[k]
        quaternion_of(self.pose, actual)
        ax, ay, az, aw = actual[0], actual[1], actual[2], actual[3]
        x, y, z, w = own[3], own[4], own[5], own[6]
        cosine = ax * x + ay * y + az * z + aw * w
        if cosine < 0.0:
            x, y, z, w, cosine = -x, -y, -z, -w, -cosine
        # The vector part of desired * conj(actual).
        ex = aw * x - w * ax + ay * z - az * y
        ey = aw * y - w * ay + az * x - ax * z
        ez = aw * z - w * az + ax * y - ay * x
        share = -1.0
        if self.is_angle:
            size = square_root(ex * ex + ey * ey + ez * ez)
            share = -2.0
            if size > 0.0:
                share = -2.0 * arctangent(size, cosine) / size
        error[3], error[4], error[5] = share * ex, share * ey, share * ez
        self.balance_error()
        self.approach_targets()

    def balance_error(self) -> None:
        """Write the torques that belong to the error."""
        jacobian = self.jacobian
        twist = self.twist
        wrench = self.wrench
        stray = self.stray
        translational, rotational = self.stiffness[0], self.stiffness[1]
        nullspace = self.stiffness[2]
        slowing = -2.0 * square_root(nullspace)
        for joint in range(self.size):
            away = self.rest[joint] - self.q[joint]
            stray[joint] = nullspace * away + slowing * self.dq[joint]
        # What pulls in the null space, less the wrench to which that is equal.
        twist_of(jacobian, stray, wrench)
        if nullspace != 0.0 and self.equation.factorise(jacobian, _INVERSE_DAMPING):
            self.equation.solve(wrench, wrench)
        twist_of(jacobian, self.dq, twist)
        for k in range(3):
            force = translational * self.error[k] + self.damping[0] * twist[k]
            wrench[k] = -force - wrench[k]
        for k in range(3, 6):
            moment = rotational * self.error[k] + self.damping[1] * twist[k]
            wrench[k] = -moment - wrench[k]
        torques = self.torques
        torques_of(jacobian, wrench, torques)
        for joint in range(self.size):
            torques[joint] += stray[joint] + self.coriolis[joint]
        last, step = self.last_torques, self.largest_step
        filter_commands(torques, last, 1.0, step, torques, self.size)

    def approach_targets(self) -> None:
        """Move stiffnesses and equilibrium on towards their targets."""
        own, target, stiffness = self.equilibrium, self.target, self.stiffness
        for k in range(3):
            stiffness[k] += _FILTER * (self.wanted[k] - stiffness[k])
            own[k] += _FILTER * (target[k] - own[k])
        for k in range(2):
            damping = 2.0 * square_root(self.wanted[k])
            self.damping[k] += _FILTER * (damping - self.damping[k])
        ax, ay, az, aw = own[3], own[4], own[5], own[6]
        x, y, z, w = target[3], target[4], target[5], target[6]
        cosine = ax * x + ay * y + az * z + aw * w
        if cosine < 0.0:
            x, y, z, w, cosine = -x, -y, -z, -w, -cosine
        first, second = 1.0 - _FILTER, _FILTER
        if not cosine > _CLOSE:
            # Half the angle between the rotations.
            size = square_root(1.0 - cosine * cosine)
            angle = arctangent(size, cosine)
            first, second = sine(first * angle) / size, sine(second * angle) / size
        x = first * ax + second * x
        y = first * ay + second * y
        z = first * az + second * z
        w = first * aw + second * w
        size = square_root(x * x + y * y + z * z + w * w)
        if size > 0.0:
            own[3], own[4], own[5], own[6] = x / size, y / size, z / size, w / size


class CartesianSpring:
    """Holds the end effector of one arm by torques. Control thread only.

    Args:
        joints: The arm's joints, claimed for torques.
        state: The arm's state.
        model: The arm's model.
        is_angle: Whether the rotation error is a rotation vector, as with two arms;
            otherwise it is the vector part of a quaternion.
        law: Class of the spring.

    Attributes:
        spring: Computes the torques.
    """

    def __init__(
        self,
        joints: JointGroup,
        state: FrankaStateHandle,
        model: FrankaModelHandle,
        *,
        is_angle: bool,
        law: type[PoseSpring] = PoseSpring,
    ) -> None:
        self._pose = state.pose_source()
        self._jacobian = model.zero_jacobian_source(Frame.END_EFFECTOR)
        self._coriolis = model.coriolis_source()
        arm = state.get_robot_state()
        self.spring = law(
            arm.doubles("q"),
            arm.doubles("dq"),
            arm.doubles("tau_J_d"),
            LARGEST_STEP,
            is_angle,
        )
        # Joints that the robot does not keep side by side in doubles take a list.
        self._copies = joints if joints.commands is None else None
        commands = joints.commands
        self._commands = self.spring.torques if commands is None else commands

    def pose(self) -> list[float]:
        """Return the measured pose O_T_EE, 16 numbers, column-major."""
        self._pose.write(self.spring.pose)
        return self.measured_pose()

    def measured_pose(self) -> list[float]:
        """Return the pose that was measured in the last cycle, 16 numbers."""
        return list(self.spring.pose)

    def equilibrium(self) -> list[float]:
        """Return the equilibrium: position [m], then quaternion w x y z, shape (7,)."""
        px, py, pz, x, y, z, w = self.spring.equilibrium
        return [px, py, pz, w, x, y, z]

    def start_at_rest(self, nullspace: float) -> None:
        """Make the present pose the equilibrium, and start without stiffness.

        Args:
            nullspace: Stiffness of the null space from the start on [Nm/rad], >= 0.
        """
        self._pose.write(self.spring.pose)
        self.spring.start_at_rest(nullspace)

    def set_target(
        self, position: NDArray[np.float64], rotation: NDArray[np.float64]
    ) -> None:
        """Set the equilibrium that is approached from now on.

        Args:
            position: In the base frame [m], shape (3,).
            rotation: Unit quaternion w x y z, shape (4,).
        """
        w, x, y, z = rotation.tolist()
        put(self.spring.target, [*position.tolist(), x, y, z, w])

    def set_stiffness(
        self, translational: float, rotational: float, nullspace: float
    ) -> None:
        """Set the stiffnesses that are approached from now on.

        Args:
            translational: Stiffness against translations [N/m], >= 0.
            rotational: Stiffness against rotations [Nm/rad], >= 0.
            nullspace: Stiffness of the joints in the null space [Nm/rad], >= 0.
        """
        put(self.spring.wanted, (translational, rotational, nullspace))

    def command_torques(self) -> None:
        """Command the torques of this cycle, then move on towards the targets."""
        spring = self.spring
        self._pose.write(spring.pose)
        self._jacobian.write(spring.jacobian)
        self._coriolis.write(spring.coriolis)
        spring.compute_torques()
        if self._copies is None:
            copy_into(self._commands, 0, spring.torques, spring.size)
        else:
            self._copies.set_commands(list(spring.torques))


class SpringUpdate:
    """The update of a controller that commands springs.

    Args:
        port: Receives the set-points.
        retarget: Sets the targets of the springs; called when the set-point in force
            may have changed.
        springs: The springs.
        timer: Tells when to publish.

    Attributes:
        published: Station time [s] and pose of the first spring's end effector, 16
            numbers, when it was published last; replaced as a whole, for any thread.
    """

    def __init__(
        self,
        port: SetPointPort,
        retarget: Callable[[], None],
        springs: list[CartesianSpring],
        timer: PublishTimer,
    ) -> None:
        self.port = port
        self.retarget = retarget
        self.springs = springs
        self.timer = timer
        self.published: tuple[float, list[float]] | None = None

    def command_springs(self, time: float) -> None:
        """Take the newest set-point, and command the springs.

        Args:
            time: Station time of the cycle [s].

        Raises:
            CommandTimeoutError: The set-point has expired and the action is `stop`.
        """
        if self.port.has_changed():
            self.retarget()
        for spring in self.springs:
            spring.command_torques()
        if self.timer.is_due(time):
            self.published = (time, self.springs[0].measured_pose())
