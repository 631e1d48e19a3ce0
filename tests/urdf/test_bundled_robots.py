"""Every URDF of example-robot-data: refused for a real defect, or the same robot to Pinocchio as the original."""

from __future__ import annotations

import dataclasses
import sysconfig
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin
import pytest

from nao_kin.errors import UrdfError
from nao_kin.urdf import parse_urdf, read_urdf, resolve_mesh
from nao_kin.urdf.elements import MeshFile

if TYPE_CHECKING:
    from nao_kin.urdf import UrdfDocument

SHARE = Path(sysconfig.get_path("purelib")) / "cmeel.prefix" / "share"
ROBOTS = SHARE / "example-robot-data" / "robots"
FILES = sorted(str(file.relative_to(ROBOTS)) for file in ROBOTS.rglob("*.urdf"))

pytestmark = pytest.mark.skipif(not FILES, reason="the extra 'robots' (example-robot-data) is not installed")

REFUSED = {
    "alex_description/urdf/alex_psyonic_hands.urdf": (1037, "'index_q1', which is not a joint"),
    "ur_description/urdf/ur3.urdf": (6, "no name"),  # an empty file: no links either
}
# Their meshes are in a vendor's installation and in a format that no mesh reader here knows.
MESHLESS = {"romeo_description/urdf/romeo_laas_small.urdf"}
ACCEPTED = [file for file in FILES if file not in REFUSED]


def bare(document: UrdfDocument) -> list[object]:
    """Links and joints without shapes, couplings and lines."""
    parts: list[object] = []
    for link in document.links:
        inertial = link.inertial and dataclasses.replace(link.inertial, line=0)
        parts.append(dataclasses.replace(link, visuals=(), collisions=(), inertial=inertial, line=0))
    for joint in document.joints:
        limit = joint.limit and dataclasses.replace(joint.limit, line=0)
        parts.append(dataclasses.replace(joint, limit=limit, mimic=None, line=0))
    return parts


def frames(model: pin.Model, q: np.ndarray) -> dict[tuple[str, str], np.ndarray]:
    data = model.createData()
    pin.framesForwardKinematics(model, data, q)
    return {(frame.name, str(frame.type)): pose.homogeneous for frame, pose in zip(model.frames, data.oMf, strict=True)}


@pytest.mark.parametrize("file", REFUSED)
def test_refusal(file: str) -> None:
    line, reason = REFUSED[file]
    with pytest.raises(UrdfError, match=reason) as caught:
        read_urdf(ROBOTS / file)
    assert caught.value.line == line


@pytest.mark.parametrize("file", ACCEPTED)
def test_pinocchio_sees_the_same_robot(file: str) -> None:
    ours = pin.buildModelFromXML(read_urdf(ROBOTS / file).to_xml())
    theirs = pin.buildModelFromUrdf(str(ROBOTS / file))
    assert list(ours.names) == list(theirs.names)
    for name in ("lowerPositionLimit", "upperPositionLimit"):
        np.testing.assert_array_equal(getattr(ours, name), getattr(theirs, name))
    generator = np.random.default_rng(len(file))
    for _ in range(3):
        q = pin.integrate(theirs, pin.neutral(theirs), generator.uniform(-3.0, 3.0, theirs.nv))
        expected, got = frames(theirs, q), frames(ours, q)
        assert got.keys() == expected.keys()
        assert max(np.abs(got[key] - expected[key]).max() for key in expected) < 1e-12
    masses = [sum(inertia.mass for inertia in model.inertias) for model in (ours, theirs)]
    assert masses[0] == pytest.approx(masses[1], rel=1e-12)


@pytest.mark.parametrize("file", ACCEPTED)
def test_writing_loses_nothing(file: str) -> None:
    document = read_urdf(ROBOTS / file)
    text = document.to_xml()
    path = Path(file).name
    again = parse_urdf(text.encode(), path)
    assert bare(again) == bare(document)
    assert (again.name, again.root) == (document.name, document.root)
    assert again.to_xml() == text


@pytest.mark.parametrize("file", ACCEPTED)
def test_meshes_are_found(file: str) -> None:
    document = read_urdf(ROBOTS / file)
    for link in document.links:
        for solid in (*link.visuals, *link.collisions):
            if not isinstance(solid.shape, MeshFile):
                continue
            name = solid.shape.filename
            if file in MESHLESS and name.startswith("file:///usr"):
                with pytest.raises(UrdfError, match="mesh format") as caught:
                    resolve_mesh(name, document.directory, path=file, line=solid.line)
                assert caught.value.line == solid.line
                continue
            found = resolve_mesh(name, document.directory)
            assert found == resolve_mesh(name, None, [SHARE])
            assert found == resolve_mesh(name, None, {"example-robot-data": SHARE / "example-robot-data"})
            assert found.is_file()


def test_line_numbers_point_at_the_elements() -> None:
    for file in ACCEPTED[::5]:
        lines = (ROBOTS / file).read_text(encoding="utf-8").splitlines()
        document = read_urdf(ROBOTS / file)
        for part in (*document.links, *document.joints):
            start = " ".join(lines[max(0, part.line - 4) : part.line])
            assert part.name in start, f"{file}:{part.line}"
