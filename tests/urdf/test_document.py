"""What an accepted file becomes, and that writing it again loses nothing."""

from __future__ import annotations

import dataclasses
import hashlib
import math
import sys
from typing import TYPE_CHECKING

import pinocchio as pin
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nao_kin.errors import UnknownNameError
from nao_kin.urdf import UrdfDocument, parse_urdf
from nao_kin.urdf.elements import Box, Cylinder, Inertial, Limit, MeshFile, Mimic, Origin, OtherShape, Sphere
from nao_kin.urdf.reader import unit

if TYPE_CHECKING:
    from nao_kin.urdf.elements import UrdfJoint, UrdfLink

TEXT = """<?xml version="1.0"?>
<robot name="two &amp; a half">
  <material name="red"><color rgba="1 0 0 1"/></material>
  <material name="late"/>
  <link name="base">
    <inertial>
      <origin xyz="0 0 0.1"/>
      <mass value="2.5"/>
      <inertia ixx="1" ixy="2" ixz="3" iyy="4" iyz="5" izz="6"/>
    </inertial>
    <visual>
      <origin xyz="1 2 3" rpy="0.1 0.2 0.3"/>
      <geometry><box size="1 2 3"/></geometry>
      <material name="red"/>
    </visual>
    <visual><geometry><cylinder radius="0.5" length="2"/></geometry><material name="unknown"/></visual>
    <visual><geometry><sphere radius="0.5"/></geometry>
      <material name="green"><color rgba="0 255 0 0.5"/><texture filename="/etc/passwd"/></material></visual>
    <collision><geometry><mesh filename="package://x/y.stl" scale="1 1 -1"/></geometry></collision>
    <collision><geometry><capsule radius="1" length="1"/></geometry></collision>
  </link>
  <link name="arm"><visual><geometry><sphere radius="0"/></geometry><material name="green"/></visual></link>
  <link name="hand"/>
  <link name="slider"/>
  <link name="plate"/>
  <joint name="shoulder" type="revolute">
    <origin xyz="0 0 1"/>
    <parent link="base"/>
    <child link="arm"/>
    <axis xyz="0 0 -2"/>
    <limit upper="1.5" effort="3"/>
  </joint>
  <joint name="wrist" type="continuous">
    <parent link="arm"/>
    <child link="hand"/>
    <mimic joint="shoulder" multiplier="-2"/>
  </joint>
  <joint name="rail" type="prismatic">
    <parent link="base"/>
    <child link="slider"/>
    <limit lower="-1" upper="1" velocity="2" effort="3"/>
    <limit lower="-9" upper="9" velocity="2" effort="3"/>
  </joint>
  <joint name="plate" type="fixed">
    <parent link="base"/><child link="plate"/><axis xyz="0 0 0"/><limit effort="1"/>
  </joint>
</robot>
"""


@pytest.fixture(scope="module")
def document() -> UrdfDocument:
    return parse_urdf(TEXT.encode(), "two.urdf")


def kinematics(document: UrdfDocument) -> tuple[list[UrdfLink], list[UrdfJoint]]:
    """What `to_xml` promises to keep, without lines."""
    links = [
        dataclasses.replace(
            link,
            visuals=(),
            collisions=(),
            line=0,
            inertial=link.inertial and dataclasses.replace(link.inertial, line=0),
        )
        for link in document.links
    ]
    joints = [
        dataclasses.replace(joint, line=0, mimic=None, limit=joint.limit and dataclasses.replace(joint.limit, line=0))
        for joint in document.joints
    ]
    return links, joints


def test_identity(document: UrdfDocument) -> None:
    assert (document.path, document.name, document.root) == ("two.urdf", "two & a half", "base")
    assert document.sha256 == hashlib.sha256(TEXT.encode()).hexdigest()
    assert document.directory is None
    assert [link.name for link in document.links] == ["base", "arm", "hand", "slider", "plate"]
    assert [joint.name for joint in document.joints] == ["shoulder", "wrist", "rail", "plate"]
    with pytest.raises(dataclasses.FrozenInstanceError):
        document.name = "other"  # type: ignore[misc]


def test_lookup(document: UrdfDocument) -> None:
    assert document.link("arm") is document.links[1]
    assert document.joint("plate") is document.joints[3]
    with pytest.raises(UnknownNameError, match=r"no joint 'Shoulder'.*'shoulder'"):
        document.joint("Shoulder")
    with pytest.raises(UnknownNameError, match=r"no link 'hnd'.*'hand'"):
        document.link("hnd")


def test_solids(document: UrdfDocument) -> None:
    box, cylinder, sphere = document.link("base").visuals
    assert box.shape == Box((1.0, 2.0, 3.0))
    assert box.origin == Origin((1.0, 2.0, 3.0), (0.1, 0.2, 0.3))
    assert box.line == 11
    assert cylinder.shape == Cylinder(0.5, 2.0)
    assert sphere.shape == Sphere(0.5)
    shapes = [solid.shape for solid in document.link("base").collisions]
    assert MeshFile("package://x/y.stl", (1.0, 1.0, -1.0)) in shapes
    assert OtherShape("capsule") in shapes, "not a shape of URDF 1.0, but there"


def test_colours(document: UrdfDocument) -> None:
    box, cylinder, sphere = document.link("base").visuals
    assert box.colour == (1.0, 0.0, 0.0, 1.0)
    assert cylinder.colour is None, "a name that nothing defines"
    assert sphere.colour == (0.0, 1.0, 0.0, 0.5), "beyond 1 is moved to 1"
    assert document.link("arm").visuals[0].colour == sphere.colour, "defined by an earlier link"


def test_inertial(document: UrdfDocument) -> None:
    expected = Inertial(2.5, Origin((0.0, 0.0, 0.1)), (1.0, 2.0, 3.0, 4.0, 5.0, 6.0), 6)
    assert document.link("base").inertial == expected
    assert document.link("arm").inertial is None


def test_joints(document: UrdfDocument) -> None:
    shoulder, wrist, rail, plate = document.joints
    assert (shoulder.kind, shoulder.parent, shoulder.child) == ("revolute", "base", "arm")
    assert shoulder.origin == Origin((0.0, 0.0, 1.0))
    assert shoulder.axis == (0.0, 0.0, -1.0)
    assert shoulder.limit == Limit(0.0, 1.5, None, 3.0, 31), "an absent end of a range is 0"
    assert (wrist.axis, wrist.limit) == ((1.0, 0.0, 0.0), None)
    assert wrist.mimic == Mimic("shoulder", -2.0, 0.0, 36)
    assert rail.limit == Limit(-1.0, 1.0, 2.0, 3.0, 41), "the first counts"
    assert (plate.axis, plate.limit, plate.mimic) == ((1.0, 0.0, 0.0), None, None), "a fixed joint has none"


def test_written_again(document: UrdfDocument) -> None:
    links, joints = kinematics(parse_urdf(document.to_xml().encode()))
    expected_links, expected_joints = kinematics(document)
    assert links == expected_links
    shoulder = expected_joints[0]
    assert shoulder.limit is not None
    unlimited = dataclasses.replace(shoulder.limit, velocity=sys.float_info.max)
    assert joints == [dataclasses.replace(shoulder, limit=unlimited), *expected_joints[1:]]


def test_pinocchio_reads_what_is_written(document: UrdfDocument) -> None:
    model = pin.buildModelFromXML(document.to_xml())
    assert sorted(model.names) == ["rail", "shoulder", "universe", "wrist"]
    assert model.name == "two & a half"


@pytest.mark.parametrize(
    "name", ["<script>alert(1)</script>", "__proto__", "../../x", "'\"&<>", "]]>", "right arm", "右肘", "{0}", "-->"]
)
def test_odd_names_arrive_unchanged(name: str) -> None:
    escaped = name.replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")
    text = f'<robot name="{escaped}"><link name="a"/><link name="{escaped}"/>'
    text += f'<joint name="{escaped}" type="continuous"><parent link="a"/><child link="{escaped}"/></joint></robot>'
    document = parse_urdf(text.encode())
    assert document.links[1].name == document.joint(name).child == name
    model = pin.buildModelFromXML(document.to_xml())
    assert list(model.names) == ["universe", name]
    assert [frame.name for frame in model.frames] == ["universe", "a", name, name]


finite = st.floats(allow_nan=False, allow_infinity=False)


@given(st.tuples(finite, finite, finite).filter(lambda v: math.hypot(*v) >= 1e-12))
def test_axes_are_of_unit_length_and_stay_as_they_are(axis: tuple[float, float, float]) -> None:
    once = unit(axis)
    assert math.hypot(*once) == pytest.approx(1.0, abs=4.5e-16)
    assert unit(once) == once
    assert all(math.copysign(1, a) == math.copysign(1, b) for a, b in zip(axis, once, strict=True))


near = st.floats(-1e9, 1e9)


@given(
    st.tuples(near, near, near),
    st.tuples(near, near, near),
    st.lists(finite, min_size=2, max_size=2).map(sorted),
    st.tuples(st.floats(0, 1e300), st.floats(0, 1e300)),
    st.text(st.characters(codec="utf-8", categories=["L", "N", "P", "S", "Zs"]), min_size=1, max_size=20),
)
def test_numbers_and_names_survive_writing(
    xyz: tuple[float, ...], rpy: tuple[float, ...], ends: list[float], most: tuple[float, float], name: str
) -> None:
    document = parse_urdf(TEXT.encode())
    origin = Origin((xyz[0], xyz[1], xyz[2]), (rpy[0], rpy[1], rpy[2]))
    name = "".join(character for character in name if character.isprintable()).replace("$", "") + "x"
    joint = dataclasses.replace(
        document.joints[0], name=name, axis=unit((0.1, 0.2, 0.3)), origin=origin, limit=Limit(*ends, *most, 0)
    )
    changed = dataclasses.replace(document, name=name, joints=(joint, *document.joints[1:]))
    again = parse_urdf(changed.to_xml().encode())
    assert again.name == name
    assert kinematics(again) == kinematics(changed)
    assert again.to_xml() == changed.to_xml()
