"""Mesh files: every part at its place, and nothing but the file itself is read."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest
import trimesh

from nao_kin.view.mesh_files import UnreadableMeshError, read_parts

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
