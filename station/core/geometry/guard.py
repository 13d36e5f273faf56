"""Slows the commands of an arm so that it can always stop clear of its scene.

The guard predicts where the arm would come to rest if it braked now. The prediction is
a line in joint space: all joints stop together, with a share of their acceleration
limits. A command passes unchanged while the arm, along that line, keeps its margin from
every solid. Otherwise the command is scaled so that the line ends where the first pair
would reach its margin. A pair that is already nearer may only move apart.

An arm also keeps clear of where any other arm is and of where that arm would come to
rest, so that both can stop whatever either of them does next.
"""

from collections.abc import Sequence

from station.core.geometry.clearances import Clearances
from station.core.geometry.distances import MARGIN, ROW
from station.core.numerics.arm_chain import least_rates, place_links, zero_jacobian
from station.core.numerics.command_rates import filter_commands, limited
from station.core.numerics.rigid_motion import twist_between
from station.memory.doubles import Doubles, Storage, doubles, zeros
from station.memory.functions import square_root

GUARD_REFLEX = "guard_reflex"
"""Name of the reflex that ends a motion which can no longer stop in time."""
PASSES, SLOWED, CANNOT_STOP = range(3)
"""Results of checking a Cartesian command: send it, slow it, or stop the arm."""
_PASSES, _SLOWED, _CANNOT_STOP = PASSES, SLOWED, CANNOT_STOP  # as C numbers
# Share of the acceleration limits with which the arm is to stop. The rest is needed to
# reverse the acceleration, and for lines that bend towards a solid.
_BRAKING_SHARE = 0.5
# Share of the acceleration limits with which a Cartesian command is expected to stop
# the joints: less than is available, because the path bends and the slower twist is
# approached gradually.
_CARTESIAN_SHARE = 0.25
# Share of the acceleration limits with which the arm stops if the command is given up.
_HARDEST = 0.8
# Part of the margin that may be lost before a command is given up [m]: an arm that
# rests at its margin trembles.
_SLACK = 5e-4
# Time to reverse the acceleration, from the largest one to that of the braking, as a
# multiple of the time in which the jerk limits build it up; with some reserve.
_TURNING = 2.5
# Share of the velocity limits with which an arm catches up after it was slowed.
_CATCH_UP = 0.25
# Share of the acceleration limits below which a Cartesian command passes again, rate at
# which its velocity is approached [1/s], share of the joints' limits that the approach
# may use, and square of the damping of the inverse kinematics.
_EXIT = 0.1
_APPROACH = 200.0
_JOINT_SHARE = 0.4
_SINGULAR = 1e-4
# Virtual spring that limits torques: width in front of the margin [m], stiffness [N/m],
# deceleration that bounds the velocity towards a solid [m/s^2], and damping of faster
# motion [N s/m].
_ZONE = 0.015
_STIFFNESS = 1500.0
_SOFT_BRAKE = 2.0
_DAMPING = 150.0


class Guard:
    """Watches one arm. Control thread only.

    Args:
        clearances: Measures the capsules of the links.
        names: Name of the link of each capsule.
        memory: The arm's state by field: `q_d`, `dq_d`, `ddq_d`, `q`, `dq`, `tau_J_d`,
            `O_T_EE_c`, `O_dP_EE_c` and `O_ddP_EE_c`.
        velocity: Largest speeds [rad/s], shape (n,).
        acceleration: Largest accelerations [rad/s^2].
        jerk: Largest jerks [rad/s^3].
        torque_step: Largest change of a torque in a cycle [Nm].
        translation: Largest velocity and acceleration of the end effector, its
            translation and then its rotation, shape (4,).
        period: Duration of a cycle [s].

    Attributes:
        is_active: Whether the scene has any solid or other arm to keep clear of.
        is_slowing: Whether the guard slows commands at present.
        interventions: Number of cycles in which a command was changed or given up.
        clearances: Distances of the pairs of a capsule and a solid.
        v: Joint velocities to check, then the slowed ones [rad/s or m/s].
        period: Duration of a cycle [s].
        committed: Ends of all axes where the arm is, then at the pose in which it would
            come to rest [m], 12 numbers per capsule.
    """

    def __init__(
        self,
        clearances: Clearances,
        names: Sequence[str],
        memory: dict[str, Doubles],
        *,
        velocity: Sequence[float],
        acceleration: Sequence[float],
        jerk: Sequence[float],
        torque_step: float,
        translation: Sequence[float],
        period: float,
    ) -> None:
        self.clearances, self.chain = clearances, clearances.chain
        self.count, self.way = clearances.count, clearances.way
        self.size = size = len(self.way)
        self.names = tuple(names)
        self.things: tuple[str, ...] = ()
        self.memory = memory
        self.q_d, self.dq_d = memory["q_d"], memory["dq_d"]
        self.ddq_d, self.q, self.dq = memory["ddq_d"], memory["q"], memory["dq"]
        self.tau_J_d = memory["tau_J_d"]
        self.last_pose, self.last_twist = memory["O_T_EE_c"], memory["O_dP_EE_c"]
        self.last_change = memory["O_ddP_EE_c"]
        self.velocity = doubles(velocity)
        self.acceleration, self.jerk = doubles(acceleration), doubles(jerk)
        self.torque_step, self.period = torque_step, period
        build_up = max(a / j for a, j in zip(acceleration, jerk, strict=True))
        # A slower loop reacts later.
        self.reaction = max(_TURNING * build_up, period) + period
        self.translation = doubles(translation)
        self.committed = zeros(12 * self.count)
        self.v, self.pushing = zeros(size), zeros(size)
        self.twist, self.jacobian = zeros(6), zeros(6 * size)
        self.matrix, self.rest = zeros(36), zeros(6)
        self.push = zeros(size)
        self.is_committing = False
        self.neighbours: list[Guard] = []
        self.arms: list[str] = []
        self.places: list[Doubles] = []
        self.set_scene([], [], [])

    def take(self, clearances: Clearances, names: Sequence[str]) -> None:
        """Watch other capsules from now on; the caller then calls `set_scene`.

        Args:
            clearances: Measures the capsules.
            names: Name of the link, or of a carried object, of each capsule.
        """
        self.clearances, self.names = clearances, tuple(names)
        self.count, self.way = clearances.count, clearances.way
        self.committed = zeros(12 * self.count)

    def set_scene(
        self,
        solids: Sequence[float],
        triangles: Sequence[float],
        things: Sequence[str],
        arm_margin: float | None = None,
    ) -> None:
        """Replace all solids by these.

        Args:
            solids: Rows of `distances` in the frame of the base.
            triangles: Their triangles.
            things: Names of the solids.
            arm_margin: Distance to keep from other arms [m]; None to ignore them.
        """
        self.fixed = len(things)
        self.arm_margin = arm_margin or 0.0
        self.others = [] if arm_margin is None else self.neighbours
        names = [
            f"{arm} {name}"
            for other, arm in zip(self.others, self.arms, strict=False)
            for name in other.names
            for _ in range(2)
        ]
        self.things = (*things, *names)
        self.clearances.set_solids([*solids, *([0.0] * (ROW * len(names)))], triangles)
        self.is_active = len(self.things) > 0
        self.is_slowing = False
        self.interventions = 0
        for i in range(self.size):
            self.push[i] = 0.0
        self.commit(self.q_d, 0.0)

    def add_neighbour(self, other: "Guard", place: Doubles, arm: str) -> None:
        """Add another arm, which counts if `set_scene` gives a margin for arms.

        Args:
            other: The other arm's guard.
            place: Pose of its base in the frame of this base, 16 numbers.
            arm: Name of the other arm.
        """
        other.is_committing = True
        self.neighbours.append(other)
        self.places.append(place)
        self.arms.append(arm)

    def allow(self, solid: int, links: Sequence[str]) -> None:
        """Set the links for which a solid counts.

        Args:
            solid: Number of the solid.
            links: Names of the links.
        """
        self.clearances.allow(solid, [name in links for name in self.names])

    def margin_of(self, solid: int) -> float:
        """Return the margin of a solid [m]."""
        margin: float = self.clearances.solids[ROW * solid + MARGIN]
        return margin

    def reflex(self) -> str:
        """Return the reason for which the arm was stopped, in words."""
        pair = self.clearances.blocking
        if pair < 0:
            return f"{GUARD_REFLEX}: too near"
        capsule, solid = divmod(pair, len(self.things))
        margin = 1000.0 * self.margin_of(solid)
        return (
            f"{GUARD_REFLEX}: {self.names[capsule]} would have come nearer than "
            f"{margin:.0f} mm to '{self.things[solid]}'"
        )

    def look(self) -> None:
        """Measure the arm as it is, in a cycle in which no controller commands it."""
        self.is_slowing = False
        if self.others:
            self.place_others()
        self.clearances.measure(self.q, _ZONE)
        self.commit(self.q, 0.0)

    def place_others(self) -> None:
        """Bring the capsules of other arms up to date."""
        row = self.fixed
        for number in range(len(self.others)):
            other = self.others[number]
            place = self.places[number]
            for i in range(2 * other.count):
                self.clearances.put_capsule(
                    row,
                    place,
                    other.committed[6 * i : 6 * i + 6],
                    other.clearances.capsules[7 * (i // 2) + 6],
                    self.arm_margin,
                )
                row += 1

    def commit(self, q: Doubles, share: float) -> None:
        """Note the present pose of the arm and the pose in which it would rest.

        Args:
            q: Joint positions [rad], shape (n,).
            share: Share of `way`, 0 to 1, at which it would rest.
        """
        if not self.is_committing:
            return
        self.put_places(q, 0.0, 0)
        self.put_places(q, share, 6)

    def put_places(self, q: Doubles, share: float, offset: int) -> None:
        """Write the ends of the axes at a share of `way` into `committed`."""
        near = self.clearances
        near.place(q, share)
        for i in range(self.count):
            for k in range(6):
                self.committed[12 * i + offset + k] = near.segments[6 * i + k]

    def look_ahead(self, q: Doubles, longest: float, braking: float) -> float:
        """Set `way` to the stopping motion from `v`; return the allowed scale of `v`.

        Args:
            q: Joint positions [rad], shape (n,).
            longest: Lower bound of the time that the arm takes to stop [s].
            braking: Share of the acceleration limits with which it stops.
        """
        time = longest
        for i in range(self.size):
            speed = self.v[i] if self.v[i] > 0.0 else -self.v[i]
            speed /= braking * self.acceleration[i]
            if speed > time:
                time = speed
        half = 0.5 * time
        for i in range(self.size):
            self.way[i] = self.v[i] * (half + self.reaction)
        if self.others:
            self.place_others()
        share = self.clearances.free_share(q, _ZONE)
        scale = 1.0
        if share < 1.0:
            # The scale s follows from half s^2 + reaction s = share (half + reaction).
            reaction = self.reaction
            room = share * (half + reaction)
            scale = 2.0 * room
            root = square_root(reaction * reaction + 4.0 * half * room)
            scale /= root + reaction
        self.commit(q, share)
        return scale

    def limit_positions(self, result: Storage) -> None:
        """Slow positions that would lead too near; else leave them as they are.

        Args:
            result: The positions to send [rad], shape (n,); changed in place.
        """
        for i in range(self.size):
            self.v[i] = (result[i] - self.q_d[i]) / self.period
        if self.passes():
            return
        self.catch_up(result)
        self.slow()
        for i in range(self.size):
            result[i] = self.q_d[i] + self.v[i] * self.period

    def catch_up(self, result: Storage) -> None:
        """Set `v` so that the arm catches up with the positions and can stop there.

        Args:
            result: The positions [rad or m], shape (n,).
        """
        rate = 1.0 / self.period
        for i in range(self.size):
            way = result[i] - self.q_d[i]
            way = way if way > 0.0 else -way
            if way > 0.0:
                most = _CATCH_UP * self.velocity[i] / way
                soft = square_root(2.0 * _BRAKING_SHARE * self.acceleration[i] / way)
                rate = most if most < rate else rate
                rate = soft if soft < rate else rate
        for i in range(self.size):
            self.v[i] = (result[i] - self.q_d[i]) * rate

    def limit_velocities(self, result: Storage) -> None:
        """Slow velocities that would lead too near; else leave them as they are.

        Args:
            result: The velocities to send [rad/s], shape (n,); changed in place.
        """
        for i in range(self.size):
            self.v[i] = result[i]
        if self.passes():
            return
        for i in range(self.size):
            self.v[i] = result[i]
        self.slow()
        for i in range(self.size):
            result[i] = self.v[i]

    def passes(self) -> bool:
        """Return whether the velocities `v` may be sent unchanged."""
        if self.is_slowing:
            for i in range(self.size):
                change = (self.v[i] - self.dq_d[i]) / self.period
                jerk = (change - self.ddq_d[i]) / self.period
                if (
                    not -self.acceleration[i] <= change <= self.acceleration[i]
                    or not -self.jerk[i] <= jerk <= self.jerk[i]
                    or not -self.velocity[i] <= self.v[i] <= self.velocity[i]
                ):
                    return False
        self.is_slowing = self.look_ahead(self.q_d, 0.0, _BRAKING_SHARE) < 1.0
        return not self.is_slowing

    def slow(self) -> None:
        """Scale `v` so that the arm can stop in time; keep the joints' limits."""
        self.interventions += 1
        scale = self.look_ahead(self.q_d, 0.0, _BRAKING_SHARE)
        for i in range(self.size):
            self.v[i] = limited(
                scale * self.v[i],
                self.dq_d[i],
                self.ddq_d[i],
                self.acceleration[i],
                self.jerk[i],
                -self.velocity[i],
                self.velocity[i],
                self.period,
            )

    def limit_pose(self, pose: Doubles) -> int:
        """If a pose is approached too fast, set `twist` to approach it slowly.

        Args:
            pose: The pose to send, 16 numbers.

        Returns:
            `PASSES`, `SLOWED`, or `CANNOT_STOP` if the arm has to stop now.
        """
        twist_between(self.last_pose, pose, self.period, self.twist)
        if self.twist_passes():
            return _PASSES
        rate, twist = 1.0, self.twist
        for k in range(0, 6, 3):
            size = square_root(
                twist[k] * twist[k]
                + twist[k + 1] * twist[k + 1]
                + twist[k + 2] * twist[k + 2]
            )
            if size > 0.0:
                j = 2 * (k // 3)
                most = _CATCH_UP * self.translation[j] / size
                soft = 2.0 * _BRAKING_SHARE * self.translation[j + 1]
                soft = square_root(soft * size * self.period) / size
                rate = most if most < rate else rate
                rate = soft if soft < rate else rate
        for k in range(6):
            twist[k] = rate * twist[k]
        return self.slow_twist()

    def limit_twist(self, twist: Doubles) -> int:
        """If a twist is too fast, set `self.twist` to a slower one.

        Args:
            twist: The twist to send [m/s, rad/s], shape (6,).

        Returns:
            As for `limit_pose`.
        """
        for k in range(6):
            self.twist[k] = twist[k]
        if self.twist_passes():
            return _PASSES
        return self.slow_twist()

    def twist_passes(self) -> bool:
        """Return whether `twist` may be sent unchanged."""
        was_slowing, rest = self.is_slowing, self.rest
        if was_slowing:
            for k in range(6):
                change = (self.twist[k] - self.last_twist[k]) / self.period
                most = _EXIT * self.translation[1 if k < 3 else 3]
                if not -most <= change <= most:
                    return False
        self.is_slowing = self.look_ahead_of_twist() < 1.0
        # Near a singular pose even a small step in the twist's acceleration needs a
        # step in joint accelerations that the arm refuses.
        if was_slowing and not self.is_slowing:
            for k in range(6):
                change = (self.twist[k] - self.last_twist[k]) / self.period
                rest[k] = change - self.last_change[k]
            self.solve_joints()
            self.is_slowing = self.share_within(self.jerk, self.period) < 1.0
        return not self.is_slowing

    def slow_twist(self) -> int:
        """Scale `twist` so that the arm can stop in time; keep the joints' limits.

        The acceleration of the twist changes only as fast as the jerk of every joint
        allows. Near a singular pose that may brake too little: then only the arm's own
        stop, joint by joint, is still in time.
        """
        self.interventions += 1
        for i in range(self.size):
            self.v[i] = self.dq_d[i]
        self.clearances.slack = _SLACK
        scale = self.look_ahead(self.q_d, 0.0, _HARDEST)
        self.clearances.slack = 0.0
        if scale < 1.0:
            return _CANNOT_STOP
        scale = self.look_ahead_of_twist()
        last, twist, rest = self.last_twist, self.twist, self.rest
        for k in range(6):
            rest[k] = _APPROACH * (scale * twist[k] - last[k])
        self.solve_joints()
        share = self.share_within(self.acceleration, 1.0)
        for k in range(6):
            wanted = share * _APPROACH * (scale * twist[k] - last[k])
            twist[k] = wanted
            rest[k] = wanted - self.last_change[k]
        self.solve_joints()
        share = self.share_within(self.jerk, self.period)
        for k in range(6):
            change = self.last_change[k] + share * (twist[k] - self.last_change[k])
            twist[k] = last[k] + change * self.period
        return _SLOWED

    def share_within(self, limits: Doubles, factor: float) -> float:
        """Return the scale <= 1 that keeps `v` within `_JOINT_SHARE` of the limits."""
        share = 1.0
        for i in range(self.size):
            size = self.v[i] if self.v[i] > 0.0 else -self.v[i]
            most = _JOINT_SHARE * factor * limits[i]
            if size * share > most:
                share = most / size
        return share

    def look_ahead_of_twist(self) -> float:
        """Return the share of `twist` with which the arm can stop in time.

        The joints are assumed to add to their present motion the least change that
        leads to the twist, because the arm's own inverse kinematics is not known.
        """
        longest, twist = 0.0, self.twist
        for k in range(0, 6, 3):
            size = square_root(
                twist[k] * twist[k]
                + twist[k + 1] * twist[k + 1]
                + twist[k + 2] * twist[k + 2]
            )
            size /= _BRAKING_SHARE * self.translation[2 * (k // 3) + 1]
            if size > longest:
                longest = size
        jacobian, links = self.jacobian, self.clearances.links
        place_links(self.chain, self.q_d, links)
        zero_jacobian(links, self.last_pose, jacobian)
        for k in range(6):
            total = twist[k]
            for i in range(self.size):
                total -= jacobian[6 * i + k] * self.dq_d[i]
            self.rest[k] = total
        self.solve_joints()
        for i in range(self.size):
            self.v[i] += self.dq_d[i]
        return self.look_ahead(self.q_d, longest, _CARTESIAN_SHARE)

    def solve_joints(self) -> None:
        """Write to `v` the least joint velocities that give the twist `rest`."""
        least_rates(self.jacobian, self.rest, self.matrix, _SINGULAR, self.v)

    def limit_torques(self, result: Storage) -> bool:
        """Push the links away from near solids.

        Args:
            result: The torques to send [Nm], shape (n,); changed in place.

        Returns:
            Whether the arm can still stop in time; if not, it has to stop now.
        """
        for i in range(self.size):
            self.v[i] = self.dq[i]
        self.clearances.slack = _SLACK
        can_stop = self.look_ahead(self.q, 0.0, _BRAKING_SHARE) >= 1.0
        self.clearances.slack = 0.0
        near = self.clearances
        is_pushed = False
        for i in range(self.size):
            is_pushed = is_pushed or self.push[i] != 0.0
            self.push[i] = 0.0
        zone = near.horizon + _ZONE
        if near.least < zone:
            near.place(self.q, 0.0)
            for capsule in range(self.count):
                for solid in range(near.solid_count):
                    gap = near.gaps[capsule * near.solid_count + solid]
                    if gap < zone and self.repel(capsule, solid, gap):
                        is_pushed = True
        if is_pushed:
            for i in range(self.size):
                result[i] += self.push[i]
            step = self.torque_step
            filter_commands(result, self.tau_J_d, 1.0, step, result, self.size)
        if is_pushed or not can_stop:
            self.interventions += 1
        return can_stop

    def repel(self, capsule: int, solid: int, gap: float) -> bool:
        """Add the torques of a damped spring that pushes a capsule off a solid.

        Returns:
            Whether the torques are not zero.
        """
        near, links = self.clearances.nearness, self.clearances.links
        last = self.clearances.owners[capsule] + 1
        self.clearances.exact(capsule, solid)
        px, py, pz = near.point[0], near.point[1], near.point[2]
        nx, ny, nz = near.normal[0], near.normal[1], near.normal[2]
        closing = 0.0
        for joint in range(last):
            k = 16 * joint
            ax, ay, az = links[k + 8], links[k + 9], links[k + 10]
            x, y, z = px - links[k + 12], py - links[k + 13], pz - links[k + 14]
            self.pushing[joint] = (
                nx * (ay * z - az * y) + ny * (az * x - ax * z) + nz * (ax * y - ay * x)
            )
            closing -= self.pushing[joint] * self.dq[joint]
        force = 0.0
        if gap < _ZONE:
            force = _STIFFNESS * (_ZONE - gap)
        if gap > 0.0:
            closing -= square_root(2.0 * _SOFT_BRAKE * gap)
        if closing > 0.0:
            force += _DAMPING * closing
        for joint in range(last):
            self.push[joint] += force * self.pushing[joint]
        return force > 0.0
