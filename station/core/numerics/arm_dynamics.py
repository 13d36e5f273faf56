"""Mass matrix, Coriolis and gravity torques of an arm that is a chain of links.

All is computed in the axes of the base and about its origin, so that the numbers of
links can be added directly. A link has a mass m [kg], a first moment m c [kg m] and a
matrix of second moments, the integral of x x^T over the mass [kg m^2], from which the
inertia and every moment of a field of accelerations follow. These are 10 numbers per
link: m, then the first moments x y z, then the second moments xx yy zz xy xz yz.
"""

from collections.abc import Sequence

from station.core.numerics.arm_chain import place_links
from station.memory.doubles import Doubles, Storage, own, own_zeros, viewed
from station.memory.vectors import copy_into


class ArmDynamics:
    """The dynamics of one arm with n joints; every argument is kept.

    Args:
        chain: The chain of n joints, see `arm_chain`.
        bodies: Mass and moments of the links in their own frames, 10 n numbers;
            `change_bodies` reads them again.
        links: Memory for the poses of the links and the flange, see `new_links`.

    Attributes:
        changes: How often `bodies` were changed.
        version: How often `bodies` or the joint positions were changed. A result is
            valid as long as the version is the same.
    """

    def __init__(self, chain: Doubles, bodies: Doubles, links: Storage) -> None:
        size = len(bodies) // 10
        self.size = size
        self.chain = own(chain)
        self.given = bodies
        self.bodies = own(bodies)
        self.links = links
        self.q = own_zeros(size)
        # Mass and moments of the links in the base frame.
        self.moments = own_zeros(10 * size)
        # Axis of each joint, and velocity of the base's origin as it turns with the
        # joint at 1 rad/s.
        self.screws = own_zeros(6 * size)
        self.wrenches = own_zeros(6 * size)
        self.changes = 0
        self.version = 0
        self.is_weighed = 0
        place_links(chain, self.q, links)

    def move_to(self, q: Sequence[float]) -> None:
        """Bring the poses of the links up to date with new joint positions.

        Args:
            q: Joint positions [rad], shape (n,).
        """
        self.move_links(viewed(q))

    def move_links(self, q: Doubles) -> None:
        """Bring the poses up to date with joint positions [rad] in memory, (n,)."""
        own, differs = self.q, 0
        for i in range(self.size):
            if q[i] != own[i]:
                own[i] = q[i]
                differs = 1
        if differs:
            place_links(self.chain, own, self.links)
            self.is_weighed = 0
            self.version += 1

    def change_bodies(self) -> None:
        """Read `bodies` again, after their owner has changed them."""
        copy_into(self.bodies, 0, self.given, 10 * self.size)
        self.changes += 1
        self.version += 1
        self.is_weighed = 0

    def weigh(self) -> None:
        """Bring moments and screws up to date with the poses and `bodies`."""
        links, bodies, moments = self.links, self.bodies, self.moments
        screws = self.screws
        self.is_weighed = 1
        for joint in range(self.size):
            k = 16 * joint
            xx, xy, xz = links[k], links[k + 1], links[k + 2]
            yx, yy, yz = links[k + 4], links[k + 5], links[k + 6]
            zx, zy, zz = links[k + 8], links[k + 9], links[k + 10]
            px, py, pz = links[k + 12], links[k + 13], links[k + 14]
            k = 6 * joint
            screws[k], screws[k + 1], screws[k + 2] = zx, zy, zz
            screws[k + 3] = py * zz - pz * zy
            screws[k + 4] = pz * zx - px * zz
            screws[k + 5] = px * zy - py * zx
            k = 10 * joint
            m, a, b, c = bodies[k], bodies[k + 1], bodies[k + 2], bodies[k + 3]
            # First moments about the link's origin in the axes of the base, then about
            # the base's origin.
            ux = a * xx + b * yx + c * zx
            uy = a * xy + b * yy + c * zy
            uz = a * xz + b * yz + c * zz
            hx, hy, hz = ux + m * px, uy + m * py, uz + m * pz
            moments[k] = m
            moments[k + 1], moments[k + 2], moments[k + 3] = hx, hy, hz
            a, b, c = bodies[k + 4], bodies[k + 5], bodies[k + 6]
            d, e, f = bodies[k + 7], bodies[k + 8], bodies[k + 9]
            # The columns of R S, to be multiplied by R^T.
            ix = a * xx + d * yx + e * zx
            iy = a * xy + d * yy + e * zy
            iz = a * xz + d * yz + e * zz
            jx = d * xx + b * yx + f * zx
            jy = d * xy + b * yy + f * zy
            jz = d * xz + b * yz + f * zz
            kx = e * xx + f * yx + c * zx
            ky = e * xy + f * yy + c * zy
            kz = e * xz + f * yz + c * zz
            moments[k + 4] = ix * xx + jx * yx + kx * zx + (ux + hx) * px
            moments[k + 5] = iy * xy + jy * yy + ky * zy + (uy + hy) * py
            moments[k + 6] = iz * xz + jz * yz + kz * zz + (uz + hz) * pz
            moments[k + 7] = ix * xy + jx * yy + kx * zy + ux * py + px * hy
            moments[k + 8] = ix * xz + jx * yz + kx * zz + ux * pz + px * hz
            moments[k + 9] = iy * xz + jy * yz + ky * zz + uy * pz + py * hz

    def mass(self, result: Doubles) -> None:
        """Write the mass matrix at the present positions.

        Args:
            result: Receives the matrix [kg m^2], n n numbers.
        """
        if not self.is_weighed:
            self.weigh()
        moments, screws, size = self.moments, self.screws, self.size
        m, hx, hy, hz, xx, yy = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        zz, xy, xz, yz = 0.0, 0.0, 0.0, 0.0
        for joint in range(size - 1, -1, -1):
            # The links from this joint on are one body.
            k = 10 * joint
            m, hx, hy = m + moments[k], hx + moments[k + 1], hy + moments[k + 2]
            hz, xx, yy = hz + moments[k + 3], xx + moments[k + 4], yy + moments[k + 5]
            zz, xy, xz = zz + moments[k + 6], xy + moments[k + 7], xz + moments[k + 8]
            yz += moments[k + 9]
            k = 6 * joint
            a, b, c = screws[k], screws[k + 1], screws[k + 2]
            u, v, w = screws[k + 3], screws[k + 4], screws[k + 5]
            # Force and moment about the base's origin that accelerate this body at
            # 1 rad/s^2.
            fx = m * u + b * hz - c * hy
            fy = m * v + c * hx - a * hz
            fz = m * w + a * hy - b * hx
            nx = (yy + zz) * a - xy * b - xz * c + hy * w - hz * v
            ny = (xx + zz) * b - xy * a - yz * c + hz * u - hx * w
            nz = (xx + yy) * c - xz * a - yz * b + hx * v - hy * u
            for other in range(joint + 1):
                k = 6 * other
                value = (
                    screws[k] * nx
                    + screws[k + 1] * ny
                    + screws[k + 2] * nz
                    + screws[k + 3] * fx
                    + screws[k + 4] * fy
                    + screws[k + 5] * fz
                )
                result[size * joint + other] = value
                result[size * other + joint] = value

    def gravity(self, acceleration: Doubles, result: Doubles) -> None:
        """Write the torques that hold the arm at the present positions.

        Args:
            acceleration: Acceleration of gravity in the base frame [m/s^2], shape (3,).
            result: Receives the torques [Nm], shape (n,).
        """
        if not self.is_weighed:
            self.weigh()
        moments, screws = self.moments, self.screws
        x, y, z = -acceleration[0], -acceleration[1], -acceleration[2]
        m, hx, hy, hz = 0.0, 0.0, 0.0, 0.0
        for joint in range(self.size - 1, -1, -1):
            k = 10 * joint
            m, hx = m + moments[k], hx + moments[k + 1]
            hy, hz = hy + moments[k + 2], hz + moments[k + 3]
            k = 6 * joint
            result[joint] = (
                screws[k] * (hy * z - hz * y)
                + screws[k + 1] * (hz * x - hx * z)
                + screws[k + 2] * (hx * y - hy * x)
                + m * (screws[k + 3] * x + screws[k + 4] * y + screws[k + 5] * z)
            )

    def coriolis(self, dq: Doubles, result: Doubles) -> None:
        """Write the Coriolis and centrifugal torques at the present positions.

        Args:
            dq: Joint velocities [rad/s], shape (n,).
            result: Receives the torques [Nm], shape (n,).
        """
        if not self.is_weighed:
            self.weigh()
        links, moments, screws = self.links, self.moments, self.screws
        wrenches = self.wrenches
        # Angular velocity; acceleration of the body's point at the base's origin; and
        # the matrix W, with which the point x has the acceleration a + W x.
        wx, wy, wz, ax, ay, az = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        ex, ey, ez, w00, w01, w02 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        w10, w11, w12, w20, w21, w22 = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for joint in range(self.size):
            k = 16 * joint
            rate = dq[joint]
            zx, zy, zz = rate * links[k + 8], rate * links[k + 9], rate * links[k + 10]
            px, py, pz = links[k + 12], links[k + 13], links[k + 14]
            # The joint's origin belongs to both links.
            ax, ay, az = (
                ax + (w00 * px + w01 * py + w02 * pz),
                ay + (w10 * px + w11 * py + w12 * pz),
                az + (w20 * px + w21 * py + w22 * pz),
            )
            ex, ey, ez = (
                ex + wy * zz - wz * zy,
                ey + wz * zx - wx * zz,
                ez + wx * zy - wy * zx,
            )
            wx, wy, wz = wx + zx, wy + zy, wz + zz
            sx, sy, sz = wx * wx, wy * wy, wz * wz
            w00, w11, w22 = -sy - sz, -sx - sz, -sx - sy
            sx, sy, sz = wy * wz, wx * wz, wx * wy
            w01, w10, w02, w20 = sz - ez, sz + ez, sy + ey, sy - ey
            w12, w21 = sx - ex, sx + ex
            ax, ay, az = (
                ax - (w00 * px + w01 * py + w02 * pz),
                ay - (w10 * px + w11 * py + w12 * pz),
                az - (w20 * px + w21 * py + w22 * pz),
            )
            k = 10 * joint
            m, hx, hy, hz = moments[k], moments[k + 1], moments[k + 2], moments[k + 3]
            xx, yy, zz = moments[k + 4], moments[k + 5], moments[k + 6]
            xy, xz, yz = moments[k + 7], moments[k + 8], moments[k + 9]
            k = 6 * joint
            # The moments of the field W x are the skew part of W S.
            wrenches[k] = (
                (w20 * xy + w21 * yy + w22 * yz)
                - (w10 * xz + w11 * yz + w12 * zz)
                + (hy * az - hz * ay)
            )
            wrenches[k + 1] = (
                (w00 * xz + w01 * yz + w02 * zz)
                - (w20 * xx + w21 * xy + w22 * xz)
                + (hz * ax - hx * az)
            )
            wrenches[k + 2] = (
                (w10 * xx + w11 * xy + w12 * xz)
                - (w00 * xy + w01 * yy + w02 * yz)
                + (hx * ay - hy * ax)
            )
            wrenches[k + 3] = m * ax + w00 * hx + w01 * hy + w02 * hz
            wrenches[k + 4] = m * ay + w10 * hx + w11 * hy + w12 * hz
            wrenches[k + 5] = m * az + w20 * hx + w21 * hy + w22 * hz
        nx, ny, nz, fx, fy, fz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for joint in range(self.size - 1, -1, -1):
            k = 6 * joint
            nx, ny, nz = nx + wrenches[k], ny + wrenches[k + 1], nz + wrenches[k + 2]
            fx, fy, fz = (
                fx + wrenches[k + 3],
                fy + wrenches[k + 4],
                fz + wrenches[k + 5],
            )
            result[joint] = (
                screws[k] * nx
                + screws[k + 1] * ny
                + screws[k + 2] * nz
                + screws[k + 3] * fx
                + screws[k + 4] * fy
                + screws[k + 5] * fz
            )
