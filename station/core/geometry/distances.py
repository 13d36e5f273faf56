"""Signed distances of capsules to convex solids, to fences and to each other.

A capsule is a segment with a radius. A solid is a row of 20 numbers: its kind; the x, y
and z axes and the origin of its frame; three sizes; the margin [m]; +1 to keep out of
it or -1 to stay inside; the index of its first triangle and the number of its
triangles. The frame of a solid is at its middle; a half-space fills its own z < 0.

Along a line, the signed distance of a point to a convex solid is a convex function. So
a segment is nearest where the slope changes its sign, and farthest at one of its ends.
"""

from collections.abc import Sequence
from math import hypot

from station.core.numerics.arm_chain import TREE_ROW
from station.memory.doubles import Doubles, Indices, Storage, zeros
from station.memory.functions import square_root

ROW = 20
"""Count of the numbers in the row of a solid."""
MARGIN = 16
"""Index of the margin in the row of a solid."""
SPHERE, CAPSULE, CYLINDER, BOX, HALF_SPACE, MESH = range(6)
"""Kinds of solids. Their sizes are: the radius of a sphere; the radius and half the
length of the axis of a capsule, between the middles of its caps, or of a cylinder; half
the edges of a box; the distance by which a mesh reaches beyond its triangles."""

# As C numbers, by the .pxd.
_SPHERE, _CAPSULE, _CYLINDER, _BOX = SPHERE, CAPSULE, CYLINDER, BOX
_HALF_SPACE = HALF_SPACE
# |u x v|^2 [m^4] below which segments u and v count as parallel, due to rounding.
_PARALLEL = 1e-12
# Length of the part of a segment to which the nearest point is narrowed [m]. The error
# of the distance is below the square of this length over the size of the solid.
_EXACT = 1e-7


class Nearness:
    """Measures the distance of one capsule to one solid, and keeps the result.

    Args:
        solids: Rows of solids, 20 numbers each.
        triangles: Corners of the triangles of all meshes, in the frame of their solid
            [m], 9 numbers each; the corners run counter-clockwise as seen from outside.

    Attributes:
        distance: Distance of the surfaces at the last measurement [m]; negative when
            they overlap.
        point: Nearest point of the capsule's axis [m], shape (3,).
        normal: Direction in which the distance grows, unit length, shape (3,).
    """

    def __init__(self, solids: Doubles, triangles: Doubles) -> None:
        self.solids = solids
        self.triangles = triangles
        self.distance = 0.0
        self.point = zeros(3)
        self.normal = zeros(3)

    def to_row(self, ends: Doubles, i: int, radius: float, o: int) -> float:
        """Return the distance of a capsule to a solid [m]; the margin is ignored.

        Args:
            ends: Ends of the axes of the capsules [m].
            i: Index of the capsule's first number.
            radius: The capsule's radius [m].
            o: Index of the solid's first number.
        """
        solids = self.solids
        ux = ends[i + 3] - ends[i]
        uy = ends[i + 4] - ends[i + 1]
        uz = ends[i + 5] - ends[i + 2]
        length = square_root(ux * ux + uy * uy + uz * uz)
        low, high = 0.0, 1.0
        if solids[o + 17] < 0.0:
            first = self.of_row(ends[i], ends[i + 1], ends[i + 2], o)
            last = self.of_row(ends[i + 3], ends[i + 4], ends[i + 5], o)
            share = 1.0 if last > first else 0.0
        else:
            self.of_row(ends[i], ends[i + 1], ends[i + 2], o)
            normal = self.normal
            share = 0.0
            if normal[0] * ux + normal[1] * uy + normal[2] * uz < 0.0:
                self.of_row(ends[i + 3], ends[i + 4], ends[i + 5], o)
                share = 1.0
                if normal[0] * ux + normal[1] * uy + normal[2] * uz > 0.0:
                    while (high - low) * length > _EXACT:
                        share = 0.5 * (low + high)
                        self.of_row(
                            ends[i] + share * ux,
                            ends[i + 1] + share * uy,
                            ends[i + 2] + share * uz,
                            o,
                        )
                        if normal[0] * ux + normal[1] * uy + normal[2] * uz < 0.0:
                            low = share
                        else:
                            high = share
        x = ends[i] + share * ux
        y = ends[i + 1] + share * uy
        z = ends[i + 2] + share * uz
        distance = self.of_row(x, y, z, o)
        if solids[o + 17] < 0.0:
            distance, normal = -distance, self.normal
            normal[0], normal[1], normal[2] = -normal[0], -normal[1], -normal[2]
        self.point[0], self.point[1], self.point[2] = x, y, z
        self.distance = distance - radius
        return self.distance

    def of_row(self, px: float, py: float, pz: float, o: int) -> float:
        """Return the signed distance of a point to a solid; negative inside [m].

        Args:
            px: x of the point in the base frame [m].
            py: y of the point [m].
            pz: z of the point [m].
            o: Index of the solid's first number.
        """
        solids = self.solids
        kind = int(solids[o])
        wx, wy, wz = px - solids[o + 10], py - solids[o + 11], pz - solids[o + 12]
        x = solids[o + 1] * wx + solids[o + 2] * wy + solids[o + 3] * wz
        y = solids[o + 4] * wx + solids[o + 5] * wy + solids[o + 6] * wz
        z = solids[o + 7] * wx + solids[o + 8] * wy + solids[o + 9] * wz
        a, b, c = solids[o + 13], solids[o + 14], solids[o + 15]
        distance = 0.0
        if kind in (_BOX, _CYLINDER):
            sx, sy, sz = 1.0, 1.0, 1.0
            if z < 0.0:
                sz, z = -1.0, -z
            if kind == _CYLINDER:
                # Like a box in two dimensions: across the axis and along it.
                across = square_root(x * x + y * y)
                sx, sy = (x / across, y / across) if across > 0.0 else (1.0, 0.0)
                x, y, z = across - a, -1.0, z - b
            else:
                if x < 0.0:
                    sx, x = -1.0, -x
                if y < 0.0:
                    sy, y = -1.0, -y
                x, y, z = x - a, y - b, z - c
            if x > 0.0 or y > 0.0 or z > 0.0:
                x, y = x if x > 0.0 else 0.0, y if y > 0.0 else 0.0
                z = z if z > 0.0 else 0.0
                distance = square_root(x * x + y * y + z * z)
                x, y, z = x / distance, y / distance, z / distance
            elif kind == _CYLINDER:
                distance = x if x > z else z
                x, y, z = (1.0, 0.0, 0.0) if x > z else (0.0, 0.0, 1.0)
            elif x >= y and x >= z:
                distance, x, y, z = x, 1.0, 0.0, 0.0
            elif y >= z:
                distance, x, y, z = y, 0.0, 1.0, 0.0
            else:
                distance, x, y, z = z, 0.0, 0.0, 1.0
            if kind == _CYLINDER:
                x, y, z = sx * x, sy * x, sz * z
            else:
                x, y, z = sx * x, sy * y, sz * z
        elif kind == _HALF_SPACE:
            distance, x, y, z = z, 0.0, 0.0, 1.0
        elif kind in (_SPHERE, _CAPSULE):
            if kind == _CAPSULE:
                z = z - b if z > b else z + b if z < -b else 0.0
            size = square_root(x * x + y * y + z * z)
            distance = size - a
            x, y, z = (x / size, y / size, z / size) if size > 0.0 else (0.0, 0.0, 1.0)
        else:
            distance = self.of_mesh(x, y, z, o) - a
            x, y, z = self.normal[0], self.normal[1], self.normal[2]
        normal = self.normal
        normal[0] = solids[o + 1] * x + solids[o + 4] * y + solids[o + 7] * z
        normal[1] = solids[o + 2] * x + solids[o + 5] * y + solids[o + 8] * z
        normal[2] = solids[o + 3] * x + solids[o + 6] * y + solids[o + 9] * z
        return distance

    def of_mesh(self, x: float, y: float, z: float, o: int) -> float:
        """Return the signed distance of a point to a convex mesh, in its frame [m].

        Args:
            x: x of the point in the frame of the solid [m].
            y: y of the point [m].
            z: z of the point [m].
            o: Index of the solid's first number.
        """
        solids, triangles, normal = self.solids, self.triangles, self.normal
        begin, count = int(solids[o + 18]), int(solids[o + 19])
        inside, best = -1e30, 1e30
        for k in range(9 * begin, 9 * (begin + count), 9):
            ax, ay, az = triangles[k], triangles[k + 1], triangles[k + 2]
            bx, by, bz = triangles[k + 3] - ax, triangles[k + 4] - ay, 0.0
            bz = triangles[k + 5] - az
            cx, cy, cz = triangles[k + 6] - ax, triangles[k + 7] - ay, 0.0
            cz = triangles[k + 8] - az
            nx, ny, nz = by * cz - bz * cy, bz * cx - bx * cz, bx * cy - by * cx
            size = square_root(nx * nx + ny * ny + nz * nz)
            wx, wy, wz = x - ax, y - ay, z - az
            height = (nx * wx + ny * wy + nz * wz) / size
            if height > inside:
                inside = height
                if height <= 0.0 and best > 1e29:
                    normal[0], normal[1], normal[2] = nx / size, ny / size, nz / size
            if height <= 0.0:
                continue
            # Barycentric coordinates of the foot of the perpendicular; outside of the
            # triangle the nearest point is on one of its edges.
            bb, cc = bx * bx + by * by + bz * bz, cx * cx + cy * cy + cz * cz
            bc = bx * cx + by * cy + bz * cz
            bw, cw = bx * wx + by * wy + bz * wz, cx * wx + cy * wy + cz * wz
            square = bb * cc - bc * bc
            s, t = (cc * bw - bc * cw) / square, (bb * cw - bc * bw) / square
            if s < 0.0 or t < 0.0 or s + t > 1.0:
                least = 1e30
                s, t = 0.0, 0.0
                e = _clipped(bw / bb)
                fx, fy, fz = wx - e * bx, wy - e * by, wz - e * bz
                least, s, t = fx * fx + fy * fy + fz * fz, e, 0.0
                e = _clipped(cw / cc)
                fx, fy, fz = wx - e * cx, wy - e * cy, wz - e * cz
                f = fx * fx + fy * fy + fz * fz
                if f < least:
                    least, s, t = f, 0.0, e
                dx, dy, dz = cx - bx, cy - by, cz - bz
                e = dx * (wx - bx) + dy * (wy - by) + dz * (wz - bz)
                e = _clipped(e / (dx * dx + dy * dy + dz * dz))
                fx, fy, fz = wx - bx - e * dx, wy - by - e * dy, wz - bz - e * dz
                f = fx * fx + fy * fy + fz * fz
                if f < least:
                    s, t = 1.0 - e, e
            fx = wx - s * bx - t * cx
            fy = wy - s * by - t * cy
            fz = wz - s * bz - t * cz
            f = square_root(fx * fx + fy * fy + fz * fz)
            if f < best and f > 0.0:
                best = f
                normal[0], normal[1], normal[2] = fx / f, fy / f, fz / f
        return inside if inside <= 0.0 else best


def _clipped(value: float) -> float:
    """Return a number clipped to the range 0 to 1."""
    return 0.0 if value < 0.0 else 1.0 if value > 1.0 else value


def nearest_points(
    first: Doubles, second: Doubles, point: Doubles, normal: Doubles
) -> float:
    """Return the distance between two segments of positive length [m].

    Args:
        first: Ends of one segment, 6 numbers.
        second: Ends of the other segment, 6 numbers.
        point: Receives the nearest point of the first segment, shape (3,).
        normal: Receives the direction from the second segment to this point, shape
            (3,).
    """
    s, t = 0.0, 0.0
    px = first[0]
    py = first[1]
    pz = first[2]
    qx = second[0]
    qy = second[1]
    qz = second[2]
    ux, uy, uz = first[3] - px, first[4] - py, first[5] - pz
    vx, vy, vz = second[3] - qx, second[4] - qy, second[5] - qz
    wx, wy, wz = px - qx, py - qy, pz - qz
    uu, vv = ux * ux + uy * uy + uz * uz, vx * vx + vy * vy + vz * vz
    uv = ux * vx + uy * vy + uz * vz
    uw, vw = ux * wx + uy * wy + uz * wz, vx * wx + vy * wy + vz * wz
    square = uu * vv - uv * uv
    # Nearest points of the lines, clipped to the segments; any point if parallel.
    if square > _PARALLEL:
        s = (uv * vw - uw * vv) / square
        s = 0.0 if s < 0.0 else 1.0 if s > 1.0 else s
    if vv > 0.0:
        t = (uv * s + vw) / vv
    if t < 0.0 or t > 1.0:
        t = 0.0 if t < 0.0 else 1.0
        if uu > 0.0:
            s = (uv * t - uw) / uu
            s = 0.0 if s < 0.0 else 1.0 if s > 1.0 else s
    x, y, z = wx + s * ux - t * vx, wy + s * uy - t * vy, wz + s * uz - t * vz
    point[0], point[1], point[2] = px + s * ux, py + s * uy, pz + s * uz
    size = square_root(x * x + y * y + z * z)
    normal[0], normal[1], normal[2] = 0.0, 0.0, 1.0
    # Axes that intersect have no direction between them, so any will do.
    if size > 0.0:
        normal[0], normal[1], normal[2] = x / size, y / size, z / size
    return size


def place_segments(
    capsules: Doubles, owners: Indices, links: Storage, segments: Doubles
) -> None:
    """Write the segments of capsules in the base frame.

    Args:
        capsules: The capsules, 7 numbers each.
        owners: For each capsule the index of its link; -1 for the base.
        links: Poses of the links, 16 numbers each.
        segments: Receives both ends of each segment [m], 6 numbers per capsule.
    """
    for capsule in range(len(owners)):
        k = 16 * owners[capsule]
        for end in range(2):
            i, o = 7 * capsule + 3 * end, 6 * capsule + 3 * end
            x, y, z = capsules[i], capsules[i + 1], capsules[i + 2]
            if k < 0:
                segments[o], segments[o + 1], segments[o + 2] = x, y, z
                continue
            segments[o] = links[k] * x + links[k + 4] * y + links[k + 8] * z
            segments[o] += links[k + 12]
            segments[o + 1] = links[k + 1] * x + links[k + 5] * y + links[k + 9] * z
            segments[o + 1] += links[k + 13]
            segments[o + 2] = links[k + 2] * x + links[k + 6] * y + links[k + 10] * z
            segments[o + 2] += links[k + 14]


def reaches(chain: Doubles, capsules: Doubles, owners: Indices) -> list[float]:
    """Return the greatest distance of any point of an arm from each joint axis [m].

    Args:
        chain: The arm, see `arm_chain`.
        capsules: Capsules of its links, 7 numbers each.
        owners: Index of the link of each capsule.
    """
    size = len(chain) // 4 - 1
    far = [0.0] * (size + 1)
    for i, link in enumerate(owners):
        k = 7 * i
        end = max(hypot(*capsules[k : k + 3]), hypot(*capsules[k + 3 : k + 6]))
        far[link] = max(far[link], end + capsules[k + 6])
    for joint in range(size - 2, -1, -1):
        step = hypot(chain[4 * joint + 4], chain[4 * joint + 5])
        far[joint] = max(far[joint], step + far[joint + 1])
    return far[:size]


def reaches_of_tree(
    tree: Doubles, capsules: Doubles, owners: Indices, longest: Sequence[float]
) -> list[float]:
    """Return the largest way of any point of a robot per unit of each link's joint.

    Args:
        tree: The robot, see `place_tree`.
        capsules: Capsules of its links, 7 numbers each.
        owners: Index of the link of each capsule.
        longest: For each link on a sliding joint, its greatest distance from 0 [m];
            other values are ignored.

    Returns:
        Distances [m] per unit of the joint [rad or m].
    """
    rows = [tree[k : k + TREE_ROW] for k in range(0, len(tree), TREE_ROW)]
    far = [0.0] * len(rows)
    for i, link in enumerate(owners):
        k = 7 * i
        end = max(hypot(*capsules[k : k + 3]), hypot(*capsules[k + 3 : k + 6]))
        far[link] = max(far[link], end + capsules[k + 6])
    for link in range(len(far) - 1, -1, -1):
        row = rows[link]
        step = hypot(*row[14:17])
        step += abs(row[3]) * longest[link] + abs(row[4]) if row[2] else 0.0
        if row[0] >= 0.0:
            parent = int(row[0])
            far[parent] = max(far[parent], step + far[link])
    return [
        abs(row[3]) * (1.0 if row[2] else reach)
        for row, reach in zip(rows, far, strict=True)
    ]
