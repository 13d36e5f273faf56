"""One URDF for several arms, each with its own prefix, on a common `world` link."""

import xml.etree.ElementTree as ET
from collections.abc import Sequence

from station.hw.franka.arm.arm_description import find_prefix
from station.hw.franka.simulated.franka_world import ArmPlacement
from station.hw.urdf_loader import load_urdf

WORLD_LINK = "world"


def combine_descriptions(placements: Sequence[ArmPlacement]) -> str:
    """Return one URDF with all arms at their places.

    Args:
        placements: The arms.

    Raises:
        RobotDescriptionError: A placement does not describe a Franka arm.
    """
    combined = ET.Element("robot", name="combined")
    ET.SubElement(combined, "link", name=WORLD_LINK)
    materials: set[str] = set()
    for placement in placements:
        prefix = f"{placement.arm_id}_"
        original = placement.description
        description = original.with_prefix(find_prefix(original), prefix)
        for element in ET.fromstring(description.xml):
            name = element.get("name", "")
            if element.tag == "material":
                if name in materials:
                    continue
                materials.add(name)
            combined.append(element)
        _stand(combined, placement, load_urdf(description).root)
    return ET.tostring(combined, encoding="unicode")


def _stand(combined: ET.Element, placement: ArmPlacement, root: str) -> None:
    name = f"{placement.arm_id}_{WORLD_LINK}_joint"
    joint = ET.SubElement(combined, "joint", name=name, type="fixed")
    ET.SubElement(joint, "parent", link=WORLD_LINK)
    ET.SubElement(joint, "child", link=root)
    roll, pitch, yaw = placement.base.rpy()
    ET.SubElement(
        joint,
        "origin",
        xyz=" ".join(repr(value) for value in placement.base.xyz),
        rpy=f"{roll!r} {pitch!r} {yaw!r}",
    )
