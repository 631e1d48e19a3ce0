"""Meshes: what is opened, and what is never opened."""

from __future__ import annotations

import os
import socket
from pathlib import Path

import pytest

import nao_kin as nk

CORPUS = Path(__file__).parent.parent / "corpus"


def box(folder: Path, *filenames: str) -> Path:
    visuals = "".join(f'<visual><geometry>\n<mesh filename="{name}"/></geometry></visual>' for name in filenames)
    path = folder / "box.urdf"
    path.write_text(f'<robot name="box"><link name="base">{visuals}</link></robot>')
    return path


def test_meshes_beyond_a_bound_are_found_but_not_opened(tmp_path: Path) -> None:
    (tmp_path / "small.stl").write_bytes((CORPUS / "meshes" / "cube.stl").read_bytes())
    with (tmp_path / "large.stl").open("wb") as file:
        file.truncate(65 * 1024 * 1024)  # a hole takes no room on the disk
    path = box(tmp_path, "small.stl", "large.stl", "small.stl")
    (finding,) = nk.check(path)
    assert (finding.code, finding.line) == ("meshes-not-opened", 3)
    assert "meshes-not-opened" not in nk.check(box(tmp_path, "small.stl")).codes


@pytest.mark.parametrize("name", ["pipe.stl", "socket.stl", "device.stl", "folder.stl", "loop.stl"])
def test_what_is_no_regular_file_is_never_opened(tmp_path: Path, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / name
    listener = socket.socket(socket.AF_UNIX)
    match name:
        case "pipe.stl":
            os.mkfifo(path)
        case "socket.stl":
            monkeypatch.chdir(tmp_path)  # the name of a socket must be short
            listener.bind(name)
        case "device.stl":
            path.symlink_to("/dev/zero")
        case "folder.stl":
            path.mkdir()
        case _:
            path.symlink_to(path)
    (finding,) = nk.check(box(tmp_path, name))
    listener.close()
    assert finding.code in {"mesh-unreadable", "mesh-outside", "mesh-missing"}


def test_a_mesh_outside_the_roots_is_not_read(tmp_path: Path) -> None:
    inside, outside = tmp_path / "inside", tmp_path / "outside"
    inside.mkdir()
    outside.mkdir()
    secret = outside / "secret.stl"
    secret.write_bytes(b"\0" * 80 + b"\xff\xff\0\0")  # damaged: opening it would say so
    (inside / "link.stl").symlink_to(secret)
    names = (
        "../outside/secret.stl",
        "link.stl",
        str(secret),
        secret.as_uri(),
        "package://inside/../outside/secret.stl",
    )
    report = nk.check(box(inside, *names))
    assert [finding.code for finding in report if finding.code == "mesh-outside"] == ["mesh-outside"] * len(names)
    assert "mesh-unreadable" not in report.codes
    assert "mesh-unreadable" in nk.check(inside / "box.urdf", packages=[outside]).codes


def test_a_missing_mesh_hints_at_one_of_nearly_its_name(tmp_path: Path) -> None:
    (tmp_path / "hand.stl").write_bytes((CORPUS / "meshes" / "cube.stl").read_bytes())
    (finding,) = nk.check(box(tmp_path, "Hand.stl"))
    assert (finding.code, finding.hint) == ("mesh-missing", "Did you mean 'hand.stl'?")


def test_a_package_is_looked_up_where_the_caller_says(tmp_path: Path) -> None:
    path = box(tmp_path, "package://far_away/cube.stl")
    assert nk.check(path).codes == ("mesh-package",)
    assert nk.check(path, packages={"far_away": CORPUS / "meshes"}).findings == ()
