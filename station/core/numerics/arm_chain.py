"""Poses and Jacobians of arms, and the equation between twists and joint motions.

Most functions are for an arm whose links form a chain of revolute joints. For a tree of
joints that turn or slide, `place_tree` computes the poses; a `JointChain` is the chain
of joints that leads through such a tree to one frame.

A chain of n joints is given by 4 (n + 1) numbers, a [m], d [m], cos alpha and sin alpha
of each joint and of the flange, after Craig's convention of Denavit and Hartenberg: the
frame of a link is the one of the link before, turned by alpha about x, moved by a along
x and d along its own z, and turned by the joint's position about z.

A pose has 16 numbers, flat and column-major. The functions here write only its first
three rows; the last row stays 0 0 0 1. The poses of the links and of the flange follow
each other in one array. A Jacobian has 6 n numbers, column-major, rows vx vy vz wx wy
wz. The outer axes of a pose are those of the frame in which the pose is given.
"""

from collections.abc import Sequence

from station.core.numerics.rigid_motion import compose, displace
from station.memory.doubles import Doubles, Storage, doubles, indices, zeros
from station.memory.functions import cosine, sine

TREE_ROW = 17
"""Count of the numbers that describe one link of a tree, see `place_tree`."""
_TREE_ROW = TREE_ROW  # as a C number, by the .pxd
_IDENTITY = (
    1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0,
    0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0,
)  # fmt: skip


def new_links(chain: Doubles) -> Doubles:
    """Return new memory for the poses of the links and the flange of a chain."""
    return doubles(_IDENTITY * (len(chain) // 4))


def place_links(chain: Storage, q: Storage, links: Storage) -> None:
    """Write the poses of the links and of the flange in the base frame.

    Args:
        chain: The chain of n joints.
        q: Joint positions [rad], shape (n,). A position that is not finite makes the
            poses of the links behind NaN.
        links: Receives n + 1 poses.
    """
    xx, xy, xz, yx, yy, yz = 1.0, 0.0, 0.0, 0.0, 1.0, 0.0
    zx, zy, zz, px, py, pz = 0.0, 0.0, 1.0, 0.0, 0.0, 0.0
    count = len(chain) // 4
    for link in range(count):
        a, d = chain[4 * link], chain[4 * link + 1]
        ca, sa = chain[4 * link + 2], chain[4 * link + 3]
        # The y and z axes turned by alpha about x, the origin moved along x and z.
        ux, uy, uz = ca * yx + sa * zx, ca * yy + sa * zy, ca * yz + sa * zz
        zx, zy, zz = ca * zx - sa * yx, ca * zy - sa * yy, ca * zz - sa * yz
        if a != 0.0:
            px, py, pz = px + a * xx, py + a * xy, pz + a * xz
        if d != 0.0:
            px, py, pz = px + d * zx, py + d * zy, pz + d * zz
        # Then all turned about z, but for the flange.
        yx, yy, yz = ux, uy, uz
        if link + 1 < count:
            angle = q[link]
            angle += angle - angle
            ct, st = cosine(angle), sine(angle)
            yx, yy, yz = ct * ux - st * xx, ct * uy - st * xy, ct * uz - st * xz
            xx, xy, xz = ct * xx + st * ux, ct * xy + st * uy, ct * xz + st * uz
        k = 16 * link
        links[k], links[k + 1], links[k + 2] = xx, xy, xz
        links[k + 4], links[k + 5], links[k + 6] = yx, yy, yz
        links[k + 8], links[k + 9], links[k + 10] = zx, zy, zz
        links[k + 12], links[k + 13], links[k + 14] = px, py, pz


def place_tree(tree: Doubles, q: Storage, links: Storage) -> None:
    """Write the poses of the moving links of any robot in the frame of its base.

    Args:
        tree: `TREE_ROW` numbers for each link, parents first: the index of its parent,
            -1 for the base; the index of its joint; 0 if the link turns about z, 1 if
            it slides along z; factor and offset that give the link's position from that
            of the joint; the link's axes and origin in the parent's frame at position
            0.
        q: Positions of the joints [rad or m].
        links: Receives the poses, 16 numbers each.
    """
    ax, ay, az, bx, by, bz = 1.0, 0.0, 0.0, 0.0, 1.0, 0.0
    cx, cy, cz, ox, oy, oz = 0.0, 0.0, 1.0, 0.0, 0.0, 0.0
    for link in range(len(tree) // _TREE_ROW):
        r, k = _TREE_ROW * link, 16 * link
        parent = int(tree[r])
        ax, ay, az, bx, by, bz = 1.0, 0.0, 0.0, 0.0, 1.0, 0.0
        cx, cy, cz, ox, oy, oz = 0.0, 0.0, 1.0, 0.0, 0.0, 0.0
        if parent >= 0:
            p = 16 * parent
            ax, ay, az = links[p], links[p + 1], links[p + 2]
            bx, by, bz = links[p + 4], links[p + 5], links[p + 6]
            cx, cy, cz = links[p + 8], links[p + 9], links[p + 10]
            ox, oy, oz = links[p + 12], links[p + 13], links[p + 14]
        for axis in range(4):
            x = tree[r + 3 * axis + 5]
            y = tree[r + 3 * axis + 6]
            z = tree[r + 3 * axis + 7]
            i = k + 4 * axis
            links[i] = ax * x + bx * y + cx * z
            links[i + 1] = ay * x + by * y + cy * z
            links[i + 2] = az * x + bz * y + cz * z
        value = tree[r + 3] * q[int(tree[r + 1])] + tree[r + 4]
        ct, st = cosine(value), sine(value)
        for i in range(k, k + 3):
            links[i + 12] += ox if i == k else oy if i == k + 1 else oz
            if tree[r + 2] > 0.0:
                links[i + 12] += value * links[i + 8]
            else:
                x, y = links[i], links[i + 4]
                links[i], links[i + 4] = ct * x + st * y, ct * y - st * x


def zero_jacobian(links: Storage, pose: Storage, result: Storage) -> None:
    """Write the Jacobian of a pose's origin in the axes of the base.

    Args:
        links: Poses of the links.
        pose: The pose in the base frame, 16 numbers.
        result: Receives the columns of the first m joints, those that move the pose;
            6 m numbers.
    """
    px, py, pz = pose[12], pose[13], pose[14]
    for joint in range(len(result) // 6):
        k = 16 * joint
        ax, ay, az = links[k + 8], links[k + 9], links[k + 10]
        x, y, z = px - links[k + 12], py - links[k + 13], pz - links[k + 14]
        k = 6 * joint
        result[k] = ay * z - az * y
        result[k + 1] = az * x - ax * z
        result[k + 2] = ax * y - ay * x
        result[k + 3], result[k + 4], result[k + 5] = ax, ay, az


def turn_to_inner_axes(pose: Doubles, vectors: Doubles, result: Doubles) -> None:
    """Convert vectors in the outer axes of a pose to the pose's own axes.

    Args:
        pose: The pose, 16 numbers.
        vectors: The vectors, 3 numbers each: a Jacobian, a twist or a wrench.
        result: Receives the vectors, as many; may be `vectors`.
    """
    a, b, c, d, e, f = pose[0], pose[1], pose[2], pose[4], pose[5], pose[6]
    g, h, i = pose[8], pose[9], pose[10]
    for k in range(0, len(vectors), 3):
        x, y, z = vectors[k], vectors[k + 1], vectors[k + 2]
        result[k] = a * x + b * y + c * z
        result[k + 1] = d * x + e * y + f * z
        result[k + 2] = g * x + h * y + i * z


def turn_to_outer_axes(pose: Doubles, vectors: Doubles, result: Doubles) -> None:
    """Convert vectors in the axes of a pose to the pose's outer axes.

    Args:
        pose: The pose, 16 numbers.
        vectors: The vectors, 3 numbers each.
        result: Receives the vectors, as many; may be `vectors`.
    """
    a, b, c, d, e, f = pose[0], pose[1], pose[2], pose[4], pose[5], pose[6]
    g, h, i = pose[8], pose[9], pose[10]
    for k in range(0, len(vectors), 3):
        x, y, z = vectors[k], vectors[k + 1], vectors[k + 2]
        result[k] = a * x + d * y + g * z
        result[k + 1] = b * x + e * y + h * z
        result[k + 2] = c * x + f * y + i * z


def twist_of(jacobian: Doubles, rates: Doubles, result: Doubles) -> None:
    """Write the twist J dq of joint velocities, or J ddq of joint accelerations.

    Args:
        jacobian: The Jacobian J of n joints.
        rates: Joint velocities [rad/s] or accelerations [rad/s^2], shape (n,).
        result: Receives the twist, shape (6,).
    """
    a, b, c, d, e, f = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    for joint in range(len(rates)):
        rate, k = rates[joint], 6 * joint
        a = a + jacobian[k] * rate
        b = b + jacobian[k + 1] * rate
        c = c + jacobian[k + 2] * rate
        d = d + jacobian[k + 3] * rate
        e = e + jacobian[k + 4] * rate
        f = f + jacobian[k + 5] * rate
    result[0], result[1], result[2], result[3], result[4], result[5] = a, b, c, d, e, f


def torques_of(jacobian: Doubles, wrench: Doubles, result: Doubles) -> None:
    """Write the joint torques J^T F of a wrench.

    Args:
        jacobian: The Jacobian J of n joints.
        wrench: Force [N], then torque [Nm], shape (6,).
        result: Receives the torques [Nm], shape (n,).
    """
    a, b, c = wrench[0], wrench[1], wrench[2]
    d, e, f = wrench[3], wrench[4], wrench[5]
    for joint in range(len(result)):
        k = 6 * joint
        result[joint] = (
            jacobian[k] * a
            + jacobian[k + 1] * b
            + jacobian[k + 2] * c
            + jacobian[k + 3] * d
            + jacobian[k + 4] * e
            + jacobian[k + 5] * f
        )


def measure_accelerations(
    links: Doubles,
    dq: Doubles,
    ddq: Doubles,
    gravity: Doubles,
    sensors: Doubles,
    result: Doubles,
) -> None:
    """Write the readings of accelerometers that are fixed to the base and to links.

    An accelerometer measures the acceleration of its point less that of gravity, in its
    own axes: at rest 9.81 m/s^2 upwards.

    Args:
        links: Poses of the links.
        dq: Joint velocities [rad/s], shape (n,).
        ddq: Joint accelerations [rad/s^2], shape (n,).
        gravity: Acceleration of gravity in the axes of the base [m/s^2], shape (3,).
        sensors: Poses in the frame of the base, of link 1, of link 2 and so on, 16
            numbers each; at most n + 1.
        result: Receives the accelerations [m/s^2], 3 numbers per sensor.
    """
    gx, gy, gz = gravity[0], gravity[1], gravity[2]
    # The axes and the origin of the link, which begins as the base.
    xx, xy, xz, yx, yy, yz = 1.0, 0.0, 0.0, 0.0, 1.0, 0.0
    zx, zy, zz, px, py, pz = 0.0, 0.0, 1.0, 0.0, 0.0, 0.0
    # Its angular velocity, angular acceleration, and acceleration less gravity.
    wx, wy, wz, ux, uy, uz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    ax, ay, az = -gx, -gy, -gz
    for link in range(len(sensors) // 16):
        if link > 0:
            k = 16 * (link - 1)
            # From the origin of the link before to this link's; it turns with the
            # link before.
            rx, ry, rz = links[k + 12] - px, links[k + 13] - py, links[k + 14] - pz
            px, py, pz = links[k + 12], links[k + 13], links[k + 14]
            sx, sy, sz = wy * rz - wz * ry, wz * rx - wx * rz, wx * ry - wy * rx
            ax += uy * rz - uz * ry + wy * sz - wz * sy
            ay += uz * rx - ux * rz + wz * sx - wx * sz
            az += ux * ry - uy * rx + wx * sy - wy * sx
            xx, xy, xz = links[k], links[k + 1], links[k + 2]
            yx, yy, yz = links[k + 4], links[k + 5], links[k + 6]
            zx, zy, zz = links[k + 8], links[k + 9], links[k + 10]
            rate, change = dq[link - 1], ddq[link - 1]
            ux += change * zx + rate * (wy * zz - wz * zy)
            uy += change * zy + rate * (wz * zx - wx * zz)
            uz += change * zz + rate * (wx * zy - wy * zx)
            wx, wy, wz = wx + rate * zx, wy + rate * zy, wz + rate * zz
        k = 16 * link
        x, y, z = sensors[k + 12], sensors[k + 13], sensors[k + 14]
        rx = xx * x + yx * y + zx * z
        ry = xy * x + yy * y + zy * z
        rz = xz * x + yz * y + zz * z
        sx, sy, sz = wy * rz - wz * ry, wz * rx - wx * rz, wx * ry - wy * rx
        x = ax + uy * rz - uz * ry + wy * sz - wz * sy
        y = ay + uz * rx - ux * rz + wz * sx - wx * sz
        z = az + ux * ry - uy * rx + wx * sy - wy * sx
        # From the axes of the base to those of the link, then to those of the sensor.
        rx = xx * x + xy * y + xz * z
        ry = yx * x + yy * y + yz * z
        rz = zx * x + zy * y + zz * z
        for axis in range(3):
            k = 16 * link + 4 * axis
            result[3 * link + axis] = (
                sensors[k] * rx + sensors[k + 1] * ry + sensors[k + 2] * rz
            )


def least_rates(
    jacobian: Doubles,
    twist: Doubles,
    matrix: Doubles,
    damping: float,
    result: Doubles,
) -> None:
    """Write the least joint velocities that give a twist, damped near singular poses.

    Args:
        jacobian: The Jacobian of n joints.
        twist: The twist [m/s, rad/s], shape (6,); it is overwritten.
        matrix: Memory for 36 numbers.
        damping: Square of the damping, > 0.
        result: Receives the velocities [rad/s], shape (n,).
    """
    size = len(result)
    for k in range(6):
        for j in range(6):
            total = damping if j == k else 0.0
            for i in range(size):
                total += jacobian[6 * i + k] * jacobian[6 * i + j]
            matrix[6 * k + j] = total
    # Gauss, without a search for pivots: the matrix is symmetric and positive.
    for k in range(6):
        for j in range(k + 1, 6):
            factor = matrix[6 * j + k] / matrix[7 * k]
            for i in range(k, 6):
                matrix[6 * j + i] -= factor * matrix[6 * k + i]
            twist[j] -= factor * twist[k]
    for k in range(5, -1, -1):
        for j in range(k + 1, 6):
            twist[k] -= matrix[6 * k + j] * twist[j]
        twist[k] = twist[k] / matrix[7 * k]
    for i in range(size):
        total = 0.0
        for k in range(6):
            total += jacobian[6 * i + k] * twist[k]
        result[i] = total


class JointChain:
    """The joints between a base and a frame.

    Args:
        size: Number n of the joint positions; the chain may have fewer joints.
        origins: Pose of each joint of the chain in the frame that carries it, then the
            pose of the frame in that of the last joint, 16 numbers each.
        axes: Axis of each joint of the chain in its own frame, 3 numbers each.
        turns: 1 for each joint that turns, 0 for each that slides.
        places: Index among the n positions of each joint of the chain.

    Attributes:
        pose: Pose of the frame in the base, 16 numbers.
        jacobian: Its Jacobian, 6 n numbers; 0 for a joint that is not in the chain.
    """

    def __init__(
        self,
        size: int,
        origins: Storage,
        axes: Storage,
        turns: Storage,
        places: Sequence[int],
    ) -> None:
        self.count = len(turns)
        self.origins = doubles(origins)
        self.axes = doubles(axes)
        self.turns = doubles(turns)
        self.indices = indices(places)
        self.pose = zeros(16)
        self.jacobian = zeros(6 * size)
        self.way = zeros(6)
        # Axis and origin of each joint in the base frame.
        self.screws = zeros(6 * len(turns))

    def place(self, q: Doubles) -> None:
        """Bring the pose up to date.

        Args:
            q: Joint positions [rad or m], shape (n,).
        """
        pose, way, axes, screws = self.pose, self.way, self.axes, self.screws
        for k in range(16):
            pose[k] = self.origins[k]
        for joint in range(self.count):
            angle = q[self.indices[joint]]
            turn_to_outer_axes(pose, axes[3 * joint : 3 * joint + 3], way)
            k = 6 * joint
            screws[k], screws[k + 1], screws[k + 2] = way[0], way[1], way[2]
            screws[k + 3], screws[k + 4], screws[k + 5] = pose[12], pose[13], pose[14]
            if self.turns[joint] != 0.0:
                way[3], way[4], way[5] = way[0], way[1], way[2]
                way[0] = way[1] = way[2] = 0.0
            else:
                way[3] = way[4] = way[5] = 0.0
            displace(pose, way, angle, pose)
            compose(pose, self.origins[16 * joint + 16 : 16 * joint + 32], pose)

    def differentiate(self) -> None:
        """Bring the Jacobian up to date with the pose."""
        px, py, pz = self.pose[12], self.pose[13], self.pose[14]
        screws, jacobian = self.screws, self.jacobian
        for joint in range(self.count):
            k, column = 6 * joint, 6 * self.indices[joint]
            ax, ay, az = screws[k], screws[k + 1], screws[k + 2]
            x, y, z = px - screws[k + 3], py - screws[k + 4], pz - screws[k + 5]
            if self.turns[joint] != 0.0:
                jacobian[column] = ay * z - az * y
                jacobian[column + 1] = az * x - ax * z
                jacobian[column + 2] = ax * y - ay * x
                jacobian[column + 3] = ax
                jacobian[column + 4] = ay
                jacobian[column + 5] = az
            else:
                jacobian[column], jacobian[column + 1] = ax, ay
                jacobian[column + 2] = az


class WrenchEquation:
    """The equation (J J^T + damping) x = b of one Jacobian, solved for many b.

    If b is a displacement of an end effector, J^T x is the smallest joint motion that
    makes it. If b = J tau for joint torques tau, x is the wrench at the end effector.
    The matrix J J^T = L D L^T has 6 x 6 numbers for any number of joints; L is unit
    lower triangular, D diagonal.
    """

    def __init__(self) -> None:
        self.l10 = self.l20 = self.l21 = self.l30 = self.l31 = self.l32 = 0.0
        self.l40 = self.l41 = self.l42 = self.l43 = 0.0
        self.l50 = self.l51 = self.l52 = self.l53 = self.l54 = 0.0
        self.d0 = self.d1 = self.d2 = self.d3 = self.d4 = self.d5 = 1.0

    def factorise(self, jacobian: Doubles, damping: float) -> bool:
        """Take a Jacobian; return whether the matrix is positive definite.

        With a damping of -s^2 it is positive definite if all singular values of J are
        above s.

        Args:
            jacobian: The Jacobian J of n joints, 6 n numbers, column-major.
            damping: Number to add to the diagonal.
        """
        g00 = g11 = g22 = g33 = g44 = g55 = damping
        g10, g20, g21, g30, g31, g32 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        g40, g41, g42, g43, g50, g51 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        g52, g53, g54 = 0.0, 0.0, 0.0
        for k in range(0, len(jacobian), 6):
            a, b, c = jacobian[k], jacobian[k + 1], jacobian[k + 2]
            d, e, f = jacobian[k + 3], jacobian[k + 4], jacobian[k + 5]
            if not (a or b or c or d or e or f):
                continue  # a joint that is kept where it is
            # Without tuples: Python makes none for an assignment of at most three
            # numbers.
            g00, g10, g11 = g00 + a * a, g10 + b * a, g11 + b * b
            g20, g21, g22 = g20 + c * a, g21 + c * b, g22 + c * c
            g30, g31, g32 = g30 + d * a, g31 + d * b, g32 + d * c
            g33, g40, g41 = g33 + d * d, g40 + e * a, g41 + e * b
            g42, g43, g44 = g42 + e * c, g43 + e * d, g44 + e * e
            g50, g51, g52 = g50 + f * a, g51 + f * b, g52 + f * c
            g53, g54, g55 = g53 + f * d, g54 + f * e, g55 + f * f
        if not g00 > 0.0:
            return False
        l10, l20, l30, l40, l50 = g10 / g00, g20 / g00, g30 / g00, g40 / g00, g50 / g00
        d1 = g11 - l10 * g10
        if not d1 > 0.0:
            return False
        g21, g31 = g21 - l20 * g10, g31 - l30 * g10
        g41, g51 = g41 - l40 * g10, g51 - l50 * g10
        l21, l31, l41, l51 = g21 / d1, g31 / d1, g41 / d1, g51 / d1
        d2 = g22 - l20 * g20 - l21 * g21
        if not d2 > 0.0:
            return False
        g32 = g32 - l30 * g20 - l31 * g21
        g42, g52 = g42 - l40 * g20 - l41 * g21, g52 - l50 * g20 - l51 * g21
        l32, l42, l52 = g32 / d2, g42 / d2, g52 / d2
        d3 = g33 - l30 * g30 - l31 * g31 - l32 * g32
        if not d3 > 0.0:
            return False
        g43 = g43 - l40 * g30 - l41 * g31 - l42 * g32
        g53 = g53 - l50 * g30 - l51 * g31 - l52 * g32
        l43, l53 = g43 / d3, g53 / d3
        d4 = g44 - l40 * g40 - l41 * g41 - l42 * g42 - l43 * g43
        if not d4 > 0.0:
            return False
        g54 = g54 - l50 * g40 - l51 * g41 - l52 * g42 - l53 * g43
        l54 = g54 / d4
        d5 = g55 - l50 * g50 - l51 * g51 - l52 * g52 - l53 * g53 - l54 * g54
        if not d5 > 0.0:
            return False
        self.l10, self.l20, self.l21, self.l30, self.l31 = l10, l20, l21, l30, l31
        self.l32, self.l40, self.l41, self.l42, self.l43 = l32, l40, l41, l42, l43
        self.l50, self.l51, self.l52, self.l53, self.l54 = l50, l51, l52, l53, l54
        self.d0, self.d1, self.d2 = g00, d1, d2
        self.d3, self.d4, self.d5 = d3, d4, d5
        return True

    def solve(self, b: Doubles, x: Doubles) -> None:
        """Solve the equation of the last Jacobian for which `factorise` was true.

        Args:
            b: The right-hand side, shape (6,).
            x: Receives the solution, shape (6,); may be `b`.
        """
        l10, l20, l30, l40 = self.l10, self.l20, self.l30, self.l40
        l50, l21, l31, l41 = self.l50, self.l21, self.l31, self.l41
        l51, l32, l42, l52 = self.l51, self.l32, self.l42, self.l52
        l43, l53, l54 = self.l43, self.l53, self.l54
        y0 = b[0]
        y1 = b[1] - l10 * y0
        y2 = b[2] - l20 * y0 - l21 * y1
        y3 = b[3] - l30 * y0 - l31 * y1 - l32 * y2
        y4 = b[4] - l40 * y0 - l41 * y1 - l42 * y2 - l43 * y3
        y5 = b[5] - l50 * y0 - l51 * y1 - l52 * y2 - l53 * y3 - l54 * y4
        y5 = y5 / self.d5
        y4 = y4 / self.d4 - l54 * y5
        y3 = y3 / self.d3 - l43 * y4 - l53 * y5
        y2 = y2 / self.d2 - l32 * y3 - l42 * y4 - l52 * y5
        y1 = y1 / self.d1 - l21 * y2 - l31 * y3 - l41 * y4 - l51 * y5
        y0 = y0 / self.d0 - l10 * y1 - l20 * y2 - l30 * y3 - l40 * y4 - l50 * y5
        x[0], x[1], x[2], x[3], x[4], x[5] = y0, y1, y2, y3, y4, y5
