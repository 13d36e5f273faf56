"""Inertias that no body has are replaced, with all that is fixed to the link."""

import pytest

from station.core.description.urdf_parser import parse_urdf
from station.hw.mujoco.inertia import repair_inertias

INERTIAL = (
    '<inertial><origin xyz="{x} 0 0"/><mass value="1"/>'
    '<inertia ixx="{i}" iyy="{i}" izz="{i}" ixy="0" ixz="0" iyz="0"/></inertial>'
)


def test_point_masses_fixed_to_a_point_mass_become_one_body() -> None:
    """Two masses of 1 kg, 2 m apart: 2 kg in the middle, moments 0, 2 and 2."""
    links = "".join(
        f'<link name="{name}">{INERTIAL.format(x=x, i=0)}</link>'
        for name, x in (("arm", 0), ("tool", 2))
    )
    urdf, (repair,) = repair_inertias(
        parse_urdf(
            f"""<robot name="r"><link name="base"/>{links}
            <joint name="j" type="continuous"><parent link="base"/><child link="arm"/>
            </joint><joint name="f" type="fixed"><parent link="arm"/>
            <child link="tool"/></joint></robot>"""
        )
    )
    arm = urdf.links["arm"].inertial
    assert (arm.mass, arm.origin.xyz) == (2.0, (1.0, 0.0, 0.0))
    assert arm.inertia[:3] == pytest.approx((4 / 3,) * 3)
    assert urdf.links["tool"].inertial is None
    assert repair.old == "0 2 2"
    assert "with 1 kg fixed to it" in repair.new


def test_good_robot_is_the_same_object() -> None:
    good = INERTIAL.format(x=0, i=0.1)
    urdf = parse_urdf(f'<robot name="r"><link name="base">{good}</link></robot>')
    assert repair_inertias(urdf) == (urdf, ())
