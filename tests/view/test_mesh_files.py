"""Mesh files: every part at its place, and nothing but the file itself is read."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest
import trimesh
from lxml import etree
from tests.conftest import needs_examples

from nao_kin.robot.known import example_robot_data_share
from nao_kin.urdf.mesh_errors import LargeMeshError
from nao_kin.view.meshes import UnreadableMeshError, read_parts

if TYPE_CHECKING:
    from pathlib import Path

DAE = """<?xml version="1.0"?>
{doctype}<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="centimeter" meter="0.01"/><up_axis>{up_axis}</up_axis></asset>
<library_images><image id="img"><init_from>{texture}</init_from></image></library_images>
<library_effects>
 <effect id="blue"><profile_COMMON><technique sid="t"><phong><diffuse><color>0.2 0.4 0.8 1</color></diffuse></phong>
 </technique></profile_COMMON></effect>
 <effect id="painted"><profile_COMMON>
  <newparam sid="surf"><surface type="2D"><init_from>img</init_from></surface></newparam>
  <newparam sid="samp"><sampler2D><source>surf</source></sampler2D></newparam>
  <technique sid="t"><phong><diffuse><texture texture="samp" texcoord="UV"/></diffuse></phong></technique>
 </profile_COMMON></effect>
</library_effects>
<library_materials>
 <material id="m1"><instance_effect url="#blue"/></material>
 <material id="m2"><instance_effect url="#painted"/></material>
</library_materials>
<library_geometries><geometry id="tri"><mesh>
 <source id="p"><float_array id="pa" count="9">0 0 0 100 0 0 0 200 0</float_array><technique_common>
  <accessor source="#pa" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
  <param name="Z" type="float"/></accessor></technique_common></source>
 <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
 <triangles count="1" material="sym"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s">
 <node id="first"><instance_geometry url="#tri"><bind_material><technique_common>
  <instance_material symbol="sym" target="#m1"/></technique_common></bind_material></instance_geometry></node>
 <node id="second"><translate>0 0 300</translate><instance_geometry url="#tri"><bind_material><technique_common>
  <instance_material symbol="sym" target="#m2"/></technique_common></bind_material></instance_geometry></node>
</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene>
</COLLADA>
"""


def dae(path: Path, doctype: str = "", up_axis: str = "Z_UP", texture: str = "none.png") -> Path:
    path.write_text(DAE.format(doctype=doctype, up_axis=up_axis, texture=texture), encoding="utf-8")
    return path


def test_parts_of_a_collada_file_keep_place_unit_and_colour(tmp_path: Path) -> None:
    first, second = read_parts(dae(tmp_path / "two.dae"))
    np.testing.assert_allclose(first.vertices[first.faces[0]], [[0, 0, 0], [1, 0, 0], [0, 2, 0]], atol=1e-7)
    np.testing.assert_allclose(second.vertices[second.faces[0]], [[0, 0, 3], [1, 0, 3], [0, 2, 3]], atol=1e-7)
    assert first.colour == pytest.approx((0.2, 0.4, 0.8, 1.0), abs=0.005)


def test_the_up_axis_is_left_alone_as_other_viewers_do(tmp_path: Path) -> None:
    upright = read_parts(dae(tmp_path / "z.dae"))[1]
    lying = read_parts(dae(tmp_path / "y.dae", up_axis="Y_UP"))[1]
    np.testing.assert_array_equal(upright.vertices, lying.vertices)


def test_a_texture_is_never_opened(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import builtins
    import io

    picture = tmp_path / "secret.png"
    picture.write_bytes(b"secret")
    path = dae(tmp_path / "painted.dae", texture=picture.as_uri())
    opened: list[object] = []
    for module in (builtins, io):
        real = module.open

        def recording(file: object, *more: object, _real: object = real, **named: object) -> object:
            opened.append(file)
            return _real(file, *more, **named)  # type: ignore[operator]

        monkeypatch.setattr(module, "open", recording)
    read_parts(path)
    assert [str(file) for file in opened if "secret" in str(file)] == []


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
def test_entities_do_not_reach_other_files(tmp_path: Path, encoding: str) -> None:
    secret = tmp_path / "secret.txt"
    secret.write_text("0 0 0 100 0 0 0 200 0", encoding="utf-8")
    text = DAE.format(
        doctype=f'<!DOCTYPE COLLADA [<!ENTITY leak SYSTEM "{secret.as_uri()}">]>', up_axis="Z_UP", texture="none.png"
    )
    text = text.replace("0 0 0 100 0 0 0 200 0", "&leak;").replace(
        'version="1.0"', f'version="1.0" encoding="{encoding}"'
    )
    path = tmp_path / "leak.dae"
    path.write_bytes(text.encode(encoding))
    with pytest.raises(UnreadableMeshError, match="DOCTYPE"):
        read_parts(path)


def test_an_archive_is_not_a_collada_file(tmp_path: Path) -> None:
    import zipfile

    path = tmp_path / "packed.dae"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("inner.dae", dae(tmp_path / "inner.dae").read_text(encoding="utf-8"))
    with pytest.raises(UnreadableMeshError, match="XML"):
        read_parts(path)


@pytest.mark.parametrize("suffix", ["stl", "obj", "ply", "off"])
def test_other_formats_are_in_metres(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"box.{suffix}"
    trimesh.creation.box((1.0, 2.0, 3.0)).export(path)
    (part,) = read_parts(path)
    np.testing.assert_allclose(np.ptp(part.vertices, axis=0), (1, 2, 3), atol=1e-6)
    assert len(part.vertices) == 24  # crisp edges, whatever the file says about normals
    assert part.colour is None


@pytest.mark.parametrize(
    ("name", "content", "reason"),
    [
        ("empty.stl", b"", "triangles"),
        ("noise.ply", b"ply\nformat ascii 1.0\n", "PLY"),
        ("points.obj", b"v 0 0 0\nv 1 0 0\n", "triangles|OBJ"),
        ("infinite.off", b"OFF\n3 1 0\n0 0 0\ninf 0 0\n0 1 0\n3 0 1 2\n", "triangles"),
        ("damaged.dae", b"<COLLADA><oops></COLLADA>", "XML"),
        ("other.dae", b"<svg/>", "DAE|triangles"),
        ("scene.gltf", b"{}", "gltf"),
    ],
)
def test_what_cannot_be_shown_says_why(tmp_path: Path, name: str, content: bytes, reason: str) -> None:
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(UnreadableMeshError, match=reason):
        read_parts(path)


def test_a_long_list_of_numbers_is_read(tmp_path: Path) -> None:
    path = dae(tmp_path / "long.dae")
    text = path.read_text(encoding="utf-8").replace("0 0 0 100 0 0 0 200 0", "0 0 0 100 0 0 0 200 0" + " " * 12_000_000)
    path.write_text(text, encoding="utf-8")
    assert len(read_parts(path)) == 2


def test_entities_that_multiply_are_refused_unread(tmp_path: Path) -> None:
    layers = "".join(f'<!ENTITY e{i} "{f"&e{i - 1};" * 10}">' for i in range(1, 12))
    path = dae(tmp_path / "laughs.dae", doctype=f'<!DOCTYPE COLLADA [<!ENTITY e0 "0 ">{layers}]>')
    path.write_text(path.read_text(encoding="utf-8").replace("0 0 0 100", "&e11; 0 0 0 100"), encoding="utf-8")
    with pytest.raises(UnreadableMeshError, match=r"DOCTYPE|amplification"):
        read_parts(path)


def test_more_tags_than_a_mesh_has_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "tags.dae"
    path.write_bytes(b"<COLLADA>" + b"<a/>" * 2_000_001 + b"</COLLADA>")
    with pytest.raises(LargeMeshError, match="tags"):
        read_parts(path)


def test_what_a_picture_paints_has_no_colour_and_is_not_lost(tmp_path: Path) -> None:
    path = dae(tmp_path / "painted.dae")
    assert read_parts(path)[1].colour is None
    undeclared = path.read_text(encoding="utf-8").replace('<surface type="2D"><init_from>img</init_from></surface>', "")
    path.write_text(undeclared, encoding="utf-8")
    assert [part.colour is None for part in read_parts(path)] == [False, True]


OBJ = "{library}v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl red\nf 1 2 3\nusemtl green\nf 1 2 4\n"
MTL = "newmtl red\nKd 1 0 0\nnewmtl green\nKd 0 0.8 0\nmap_Kd secret.png\n"


def test_an_obj_file_has_the_colours_of_its_library(tmp_path: Path) -> None:
    (tmp_path / "colours.mtl").write_text(MTL, encoding="utf-8")
    path = tmp_path / "two.obj"
    path.write_text(OBJ.format(library="mtllib ./colours.mtl\n"), encoding="utf-8")
    parts = {part.colour: part for part in read_parts(path)}
    assert sorted(parts) == [(0.0, 0.8, 0.0, 1.0), (1.0, 0.0, 0.0, 1.0)]
    np.testing.assert_array_equal(parts[1.0, 0.0, 0.0, 1.0].vertices, [(0, 0, 0), (1, 0, 0), (0, 1, 0)])


@pytest.mark.parametrize(
    "library", ["", "mtllib ../outside.mtl\n", "mtllib {outside}\n", "mtllib link.mtl\n", "mtllib colours.txt\n"]
)
def test_a_library_elsewhere_or_of_another_kind_is_not_read(tmp_path: Path, library: str) -> None:
    folder, outside = tmp_path / "inside", tmp_path / "outside.mtl"
    folder.mkdir()
    outside.write_text(MTL, encoding="utf-8")
    (folder / "colours.txt").write_text(MTL, encoding="utf-8")
    (folder / "link.mtl").symlink_to(outside)
    path = folder / "two.obj"
    path.write_text(OBJ.format(library=library.format(outside=outside)), encoding="utf-8")
    parts = read_parts(path)
    assert sum(len(part.faces) for part in parts) == 2
    assert [part.colour for part in parts] == [None] * len(parts)


def test_coloured_faces_become_one_part_a_colour_and_a_painting_one_part(tmp_path: Path) -> None:
    box, ball = trimesh.creation.box(), trimesh.creation.icosphere(2)
    for body, parts in ((box, 12), (ball, 1)):
        colours = _colours(len(body.faces))
        body.visual.face_colors = colours
        body.export(tmp_path / "body.ply")
        found = read_parts(tmp_path / "body.ply")
        assert (len(found), sum(len(part.faces) for part in found)) == (parts, len(body.faces))
        named = {tuple(colour / 255) for colour in colours}
        assert {part.colour for part in found} <= named
        assert len({part.colour for part in found}) == parts


def _colours(count: int) -> np.ndarray:
    return np.stack([np.arange(count) % 256, np.arange(count) // 256, np.full(count, 7), np.full(count, 255)], axis=1)


def example(name: str) -> Path:
    needs_examples()
    share = example_robot_data_share()
    assert share is not None
    return share / "example-robot-data" / "robots" / name


@pytest.mark.parametrize(
    "name",
    [
        "ur_description/meshes/ur5/visual/wrist1.dae",
        "panda_description/meshes/visual/link0.dae",
        "laikago_description/meshes/trunk.obj",
        "talos_data/meshes/torso/torso_2.STL",
    ],
)
def test_every_sub_mesh_of_a_file_is_there(name: str) -> None:
    path = example(name)
    whole = trimesh.load_scene(path)
    parts = read_parts(path)
    assert len(parts) == len(whole.geometry)
    area = sum(trimesh.Trimesh(part.vertices, part.faces, process=False).area for part in parts)
    assert area == pytest.approx(whole.area, rel=1e-6)
    cloud = np.vstack([part.vertices for part in parts])
    np.testing.assert_allclose([cloud.min(axis=0), cloud.max(axis=0)], whole.bounds, atol=1e-6)


def test_every_colour_of_a_collada_file_is_there() -> None:
    path = example("panda_description/meshes/visual/link0.dae")
    space = {"c": "http://www.collada.org/2005/11/COLLADASchema"}
    diffuse = etree.parse(path).findall(".//c:diffuse/c:color", space)
    expected = {tuple(round(255 * float(channel)) for channel in colour.text.split()) for colour in diffuse}
    found = {tuple(round(255 * channel) for channel in part.colour) for part in read_parts(path)}
    assert len(expected) > 1
    assert np.abs(np.array(sorted(found)) - np.array(sorted(expected))).max() <= 1


def test_meshes_that_say_y_up_cover_their_twins_without_a_word_only_unturned() -> None:
    for number in range(1, 5):
        collision = example(f"tiago_description/meshes/arm/arm_{number}_collision.dae")
        assert b"Y_UP" in collision.read_bytes()
        corners = []
        for path in (collision, collision.with_name(f"arm_{number}.stl")):
            cloud = np.vstack([part.vertices for part in read_parts(path)])
            corners.append([cloud.min(axis=0), cloud.max(axis=0)])
        np.testing.assert_allclose(*corners, atol=2e-3)
