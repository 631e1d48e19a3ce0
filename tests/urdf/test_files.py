"""What stands where a file should: each kind is refused at once, without blocking and without being read."""

from __future__ import annotations

import os
import socket
from pathlib import Path

import pytest

from nao_kin.errors import UrdfError
from nao_kin.urdf import LIMITS, read_urdf

MINIMAL = '<robot name="r"><link name="a"/></robot>'


def refusal(path: str | os.PathLike[str]) -> UrdfError:
    with pytest.raises(UrdfError) as caught:
        read_urdf(path)
    assert caught.value.line is None
    assert caught.value.path == os.fspath(path)
    return caught.value


def test_regular_file_and_link_to_one(tmp_path: Path) -> None:
    file = tmp_path / "robot.urdf"
    file.write_text(MINIMAL)
    document = read_urdf(file)
    assert document.path == str(file)
    assert document.directory == tmp_path
    link = tmp_path / "link.urdf"
    link.symlink_to(file)
    assert read_urdf(str(link)).sha256 == document.sha256


def test_relative_path_has_an_absolute_directory(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "robot.urdf").write_text(MINIMAL)
    monkeypatch.chdir(tmp_path)
    assert read_urdf("robot.urdf").directory == tmp_path


def test_missing_file(tmp_path: Path) -> None:
    assert "no such file" in refusal(tmp_path / "robot.urdf").reason


def test_directory(tmp_path: Path) -> None:
    assert "directory" in refusal(tmp_path).reason


def test_named_pipe_does_not_block(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe.urdf"
    os.mkfifo(pipe)
    assert "named pipe" in refusal(pipe).reason


def test_named_pipe_that_takes_the_place_of_a_file_does_not_block(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pipe, file = tmp_path / "pipe.urdf", tmp_path / "robot.urdf"
    os.mkfifo(pipe)
    file.write_text(MINIMAL)
    status = file.stat()

    def before_the_exchange(*args: object, **kwargs: object) -> os.stat_result:
        return status

    monkeypatch.setattr(os, "stat", before_the_exchange)
    with pytest.raises(UrdfError, match="named pipe"):
        read_urdf(pipe)


def test_socket(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)  # the address of a socket must be short
    with socket.socket(socket.AF_UNIX) as server:
        server.bind("s.urdf")
        assert "socket" in refusal("s.urdf").reason


@pytest.mark.parametrize("device", ["/dev/zero", "/dev/random", "/dev/tty"])
def test_device(device: str) -> None:
    if not Path(device).exists():
        pytest.skip(f"{device} does not exist here")
    assert "device" in refusal(device).reason


def test_circle_of_links(tmp_path: Path) -> None:
    (tmp_path / "a.urdf").symlink_to(tmp_path / "b.urdf")
    (tmp_path / "b.urdf").symlink_to(tmp_path / "a.urdf")
    assert "cannot be read" in refusal(tmp_path / "a.urdf").reason


def test_dangling_link(tmp_path: Path) -> None:
    (tmp_path / "a.urdf").symlink_to(tmp_path / "nothing")
    assert "no such file" in refusal(tmp_path / "a.urdf").reason


def test_name_with_nul() -> None:
    assert "cannot be read" in refusal("robot\0.urdf").reason


def test_name_too_long() -> None:
    assert "cannot be read" in refusal("x" * 5000).reason


def test_file_below_a_file(tmp_path: Path) -> None:
    (tmp_path / "a").write_text("")
    assert "cannot be read" in refusal(tmp_path / "a" / "robot.urdf").reason


@pytest.mark.skipif(os.geteuid() == 0, reason="the superuser may read every file")
def test_no_permission(tmp_path: Path) -> None:
    file = tmp_path / "robot.urdf"
    file.write_text(MINIMAL)
    file.chmod(0)
    assert "Permission denied" in refusal(file).reason


def test_permission_error_is_translated(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "robot.urdf"
    file.write_text(MINIMAL)

    def denied(*args: object) -> int:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(os, "open", denied)
    with pytest.raises(UrdfError, match="cannot be read: Permission denied"):
        read_urdf(file)


def test_size_limit_is_seen_before_reading(tmp_path: Path) -> None:
    file = tmp_path / "robot.urdf"
    with file.open("wb") as stream:
        stream.truncate(LIMITS.file_bytes * 1000)  # sparse: 32 GB that no disk holds
    assert "at most" in refusal(file).reason


def test_file_that_claims_to_be_empty_is_not_read_without_end() -> None:
    # A file of the kernel has size 0 whatever it holds.
    assert "well-formed" in _reason("/proc/self/status")


def _reason(path: str) -> str:
    if not Path(path).exists():
        pytest.skip(f"{path} does not exist here")
    with pytest.raises(UrdfError) as caught:
        read_urdf(path)
    return caught.value.reason
