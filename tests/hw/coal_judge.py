"""Coal and Pinocchio as a judge of distances: another kinematics, other algorithms."""

from collections.abc import Sequence

import coal
import numpy as np
import pinocchio as pin

from station.core.description.robot_files import load_robot_files
from station.core.geometry.scene import SceneObject

OPEN = 0.04
"""Position of the fingers [m], as the judge of MuJoCo has them."""


class CoalJudge:
    """Measures a robot against objects.

    Args:
        things: The objects.
        reference: The robot.
        rest: Positions of the joints behind those that are told.
    """

    def __init__(
        self,
        things: Sequence[SceneObject],
        reference: str = "example-robot-data:panda",
        rest: Sequence[float] = (OPEN, OPEN),
    ) -> None:
        self._rest = rest
        files = load_robot_files(reference)
        xml = files.xml
        for uri in {part.split('"')[0] for part in xml.split('mesh filename="')[1:]}:
            xml = xml.replace(f'"{uri}"', f'"{files.resolve_mesh(uri)}"')
        self.model = pin.buildModelFromXML(xml)
        kind = pin.GeometryType.COLLISION
        self.links = pin.buildGeomFromUrdfString(self.model, xml, kind)
        self.data, self.placed = self.model.createData(), self.links.createData()
        self.shapes = []
        keeps_triangles = True
        for k, link in enumerate(self.links.geometryObjects):
            if not link.parentJoint:
                continue  # the base
            shape = link.geometry
            if isinstance(shape, coal.BVHModelBase):
                # The representation of the mesh as it is would not be convex.
                shape.buildConvexHull(keeps_triangles, "Qt")
                shape = shape.convex
            shape.computeLocalAABB()
            self.shapes.append((k, shape))
        self.things = [(_shape(one), _placement(one), _reach(one)) for one in things]

    def closest(self, q: np.ndarray) -> float:
        """Return the least distance of the robot to an object [m].

        Args:
            q: Positions of its joints from the base on [rad].
        """
        positions = np.array([*q, *self._rest])
        pin.updateGeometryPlacements(
            self.model, self.data, self.links, self.placed, positions
        )
        best, request = np.inf, coal.DistanceRequest()
        for k, shape in self.shapes:
            at = self.placed.oMg[k]
            place = coal.Transform3s(at.rotation, at.translation)
            middle = at.act(shape.aabb_center)
            for thing, where, reach in self.things:
                # Spheres around both: what they say is at least so far away.
                apart = np.linalg.norm(middle - where.getTranslation())
                if apart - shape.aabb_radius - reach >= best:
                    continue
                result = coal.DistanceResult()
                far = coal.distance(shape, place, thing, where, request, result)
                best = min(best, far)
        return float(best)


def _shape(thing: SceneObject) -> coal.CollisionGeometry:
    match thing.kind:
        case "sphere":
            shape = coal.Sphere(thing.size[0])
        case "cylinder":
            shape = coal.Cylinder(*thing.size)
        case "capsule":
            shape = coal.Capsule(*thing.size)
        case "half_space":
            return coal.Halfspace(np.array([0.0, 0.0, 1.0]), 0.0)
        case _:
            shape = coal.Box(*thing.size)
    shape.computeLocalAABB()
    return shape


def _reach(thing: SceneObject) -> float:
    """Return the radius of a ball around an object [m]."""
    endless = thing.kind == "half_space"
    return np.inf if endless else _shape(thing).aabb_radius


def _placement(thing: SceneObject) -> coal.Transform3s:
    pose = thing.pose()
    w, x, y, z = pose.quaternion
    return coal.Transform3s(pin.Quaternion(w, x, y, z).matrix(), np.array(pose.xyz))
