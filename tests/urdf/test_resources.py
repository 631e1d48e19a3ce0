"""Meshes are found below the allowed folders, and nowhere else."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

import pytest

from nao_kin.errors import UrdfError
from nao_kin.urdf import LIMITS, resolve_mesh

if TYPE_CHECKING:
    from pathlib import Path


@pytest.fixture
def world(tmp_path: Path) -> Path:
    """A workspace with two packages, a document in one of them, and a secret beside the workspace."""
    root = tmp_path.resolve()
    for file in (
        "ws/robot/package.xml",
        "ws/robot/urdf/robot.urdf",
        "ws/robot/urdf/near.stl",
        "ws/robot/urdf/sub/deep.obj",
        "ws/robot/meshes/arm.STL",
        "ws/robot/meshes/key.pem",
        "ws/hands/meshes/hand.dae",
        "secret/secret.stl",
    ):
        (root / file).parent.mkdir(parents=True, exist_ok=True)
        (root / file).write_text("x")
    return root


def refusal(name: str, directory: Path | None, roots: object = (), line: int | None = 7) -> str:
    with pytest.raises(UrdfError) as caught:
        resolve_mesh(name, directory, roots, path="robot.urdf", line=line)  # type: ignore[arg-type]
    assert (caught.value.path, caught.value.line) == ("robot.urdf", line)
    assert str(caught.value).isprintable()
    assert len(str(caught.value)) < 400
    return caught.value.reason


@pytest.mark.parametrize(
    ("name", "found"),
    {
        "near.stl": "ws/robot/urdf/near.stl",
        "./sub/../near.stl": "ws/robot/urdf/near.stl",
        "sub/deep.obj": "ws/robot/urdf/sub/deep.obj",
        "../meshes/arm.STL": "ws/robot/meshes/arm.STL",  # the document's own package
        "package://robot/meshes/arm.STL": "ws/robot/meshes/arm.STL",
        "package:///robot/meshes/arm.STL": "ws/robot/meshes/arm.STL",
        "package://robot//meshes/../meshes/arm.STL": "ws/robot/meshes/arm.STL",
        "PACKAGE://robot/meshes/arm.STL": "ws/robot/meshes/arm.STL",
        "model://robot/meshes/arm.STL": "ws/robot/meshes/arm.STL",
        "package://hands/meshes/hand.dae": "ws/hands/meshes/hand.dae",  # beside the document's package
    }.items(),
)
def test_found_from_the_document(world: Path, name: str, found: str) -> None:
    assert resolve_mesh(name, world / "ws/robot/urdf") == world / found


def test_absolute_names_within_the_allowed_folders(world: Path) -> None:
    mesh, directory = world / "ws/robot/meshes/arm.STL", world / "ws/robot/urdf"
    assert resolve_mesh(str(mesh), directory) == mesh
    assert resolve_mesh(f"file://{mesh}", directory) == mesh
    assert resolve_mesh(f"file://localhost{mesh}", directory) == mesh
    assert resolve_mesh(f"file:{mesh}", directory) == mesh
    assert resolve_mesh(f"file://{str(mesh).replace('arm', '%61rm')}", directory) == mesh
    assert resolve_mesh(str(mesh), None, [world]) == mesh


def test_given_roots(world: Path) -> None:
    mesh = world / "ws/hands/meshes/hand.dae"
    name = "package://hands/meshes/hand.dae"
    for roots in (
        [world / "ws"],
        [str(world / "ws")],
        str(world / "ws"),
        [world / "ws/hands"],
        {"hands": world / "ws/hands"},
    ):
        assert resolve_mesh(name, None, roots) == mesh
    assert resolve_mesh("package://other/meshes/hand.dae", None, {"other": world / "ws/hands"}) == mesh
    assert "not there" in refusal(name, None, {"robot": world / "ws/robot"})
    assert "not there" in refusal(name, None, [world / "missing"])
    assert "not there" in refusal(name, None)


@pytest.mark.parametrize(
    ("name", "reason"),
    {
        "../../../secret/secret.stl": "outside",
        "package://robot/../../secret/secret.stl": "outside",
        "package://hands/../../secret/secret.stl": "outside",
        "package://../secret/secret.stl": "names no package",
        "package://./secret.stl": "names no package",
        "package://.ssh/key.stl": "names no package",
        "package://": "mesh format",
        "package:///x.stl": "not there",
        "missing.stl": "not there",
        "near.stl/x.stl": "not there",
        "http://127.0.0.1:9/x.stl": "'http'",
        "https://example.org/x.stl": "'https'",
        "ftp:x.stl": "'ftp'",
        "data:model/stl;base64,x.stl": "'data'",
        "file://server/x.stl": "absolute",
        "file://x.stl": "absolute",
        "file:///etc/%00/x.stl": "absolute",
        "\\\\server\\x.stl": "not there",
        "C:\\x.stl": "not there",
        "x\0.stl": "not a file name",
        "": "not a file name",
        " ": "not a file name",
        "/etc/passwd": "mesh format",
        "../meshes/key.pem": "mesh format",
        "/dev/zero": "mesh format",
        "x" * 300 + ".stl": "not there",
        "package://" + "x" * 300 + "/x.stl": "names no package",
        "x/" * 2500 + ".stl": "mesh format|4096",
        "\x1b[2J.stl": "not there",
    }.items(),
    ids=lambda value: repr(value[:30]),
)
def test_refused(world: Path, name: str, reason: str) -> None:
    said = refusal(name, world / "ws/robot/urdf")
    assert any(part in said for part in reason.split("|")), said


def test_absolute_name_outside(world: Path) -> None:
    secret = world / "secret/secret.stl"
    for name in (str(secret), f"file://{secret}", f"file://{world}/ws/robot/%2e%2e/%2e%2e/secret/secret.stl"):
        assert "outside" in refusal(name, world / "ws/robot/urdf")


def test_without_a_folder(world: Path) -> None:
    assert "no folder" in refusal("near.stl", None, [world], line=None)


def test_symbolic_links_lead_nowhere_else(world: Path) -> None:
    directory = world / "ws/robot/urdf"
    (directory / "linked.stl").symlink_to(world / "secret/secret.stl")
    (directory / "folder").symlink_to(world / "secret")
    (world / "ws/pack").symlink_to(world / "secret")
    (directory / "key.stl").symlink_to("../meshes/key.pem")
    (directory / "inner.stl").symlink_to("../meshes/arm.STL")
    (directory / "circle.stl").symlink_to("circle.stl")
    assert "outside" in refusal("linked.stl", directory)
    assert "outside" in refusal("folder/secret.stl", directory)
    assert "not there" in refusal("package://pack/secret.stl", directory)
    assert "outside" in refusal("package://pack/secret.stl", directory, [world / "ws"])
    assert "ending" in refusal("key.stl", directory)
    assert "not there" in refusal("circle.stl", directory)
    assert resolve_mesh("inner.stl", directory) == world / "ws/robot/meshes/arm.STL"
    assert resolve_mesh("package://pack/secret.stl", directory, {"pack": world / "ws/pack"}).name == "secret.stl"


def test_document_behind_a_linked_folder(world: Path) -> None:
    (world / "short").symlink_to(world / "ws/robot/urdf")
    assert resolve_mesh("near.stl", world / "short") == world / "ws/robot/urdf/near.stl"


def test_only_regular_files_of_reasonable_size(world: Path) -> None:
    directory = world / "ws/robot/urdf"
    os.mkfifo(directory / "pipe.stl")
    (directory / "folder.stl").mkdir()
    with (directory / "huge.stl").open("wb") as stream:
        stream.truncate(LIMITS.mesh_bytes + 1)
    with (directory / "large.stl").open("wb") as stream:
        stream.truncate(LIMITS.mesh_bytes)
    assert "regular" in refusal("pipe.stl", directory)
    assert "regular" in refusal("folder.stl", directory)
    assert "at most" in refusal("huge.stl", directory)
    assert resolve_mesh("large.stl", directory).name == "large.stl"


def test_home_and_top_folders_are_no_packages(world: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    home = world / "ws"
    monkeypatch.setenv("HOME", str(home))
    directory = home / "robot/urdf"
    assert "not there" in refusal("package://hands/meshes/hand.dae", directory)
    assert "not there" in refusal("package://ws/hands/meshes/hand.dae", directory)
    (home / "hands/package.xml").write_text("x")
    assert resolve_mesh("package://hands/meshes/hand.dae", directory) == home / "hands/meshes/hand.dae"
    top = world.parts[1]
    assert "not there" in refusal(f"package://{top}/{'/'.join(world.parts[2:])}/secret/secret.stl", directory)
