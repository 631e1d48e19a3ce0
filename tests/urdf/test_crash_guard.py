"""The nastiest files in a process of their own, with little memory and time: it must end with a clean verdict."""

from __future__ import annotations

import resource
import subprocess
import sys
from pathlib import Path

import pytest

PROGRAM = """
import sys
from nao_kin.errors import UrdfError
from nao_kin.urdf import read_urdf
try:
    document = read_urdf(sys.argv[1])
except UrdfError as error:
    print("refused:", error)
else:
    print("accepted:", document.name)
    if "--load" in sys.argv:
        import pinocchio
        model = pinocchio.buildModelFromXML(document.to_xml())
        pinocchio.forwardKinematics(model, model.createData(), pinocchio.neutral(model))
        print("loaded:", model.njoints)
"""
MEMORY = 512 * 1024 * 1024
SECONDS = 20

TAIL = b'<link name="a"/></robot>'
BOMB = (
    b"<!DOCTYPE r [<!ENTITY a0 'xxxxxxxxxx'>"
    + b"".join(b"<!ENTITY a%d '%s'>" % (i + 1, b"&a%d;" % i * 10) for i in range(12))
    + b"]>"
)
LIMIT = b'<limit lower="-1" upper="1" velocity="1" effort="1"/>'


def joints(count: int, kind: bytes) -> bytes:
    joint = b'<link name="l%d"/><joint name="j%d" type="%s"><parent link="l%d"/><child link="l%d"/>%s</joint>'
    parts = [joint % (i, i, kind, i, i + 1, LIMIT) for i in range(count)]
    return b'<robot name="r">' + b"".join(parts) + b'<link name="l%d"/></robot>' % count


NASTY = {
    "entity bomb in text": BOMB + b'<robot name="r">&a12;' + TAIL,
    "entity bomb in a value": BOMB + b'<robot name="&a12;">' + TAIL,
    "quadratic blowup": b"<!DOCTYPE r [<!ENTITY a '" + b"x" * 100_000 + b"'>]><robot>" + b"&a;" * 100_000 + b"</robot>",
    "device as entity": b"<!DOCTYPE r [<!ENTITY a SYSTEM '/dev/zero'>]><robot name='r'>&a;" + TAIL,
    "device as DTD": b"<!DOCTYPE r SYSTEM '/dev/zero'><robot name='r'>" + TAIL,
    "open comment": b"<!--" + b"-" * 30_000_000,
    "comments": b"<!---->" * 4_000_000,
    "blank prolog": b" " * 33_000_000 + b"<robot/>",
    "one text": b"<robot>" + b"x" * 33_000_000,
    "nesting": b'<robot name="r">' + b"<a>" * 11_000_000,
    "elements": b'<robot name="r">' + b"<a/>" * 8_000_000 + TAIL,
    "attributes": b"<robot " + b" ".join(b"a%d=''" % i for i in range(2_000_000)) + b"/>",
    "attributes at the limit": b"<robot " + b" ".join(b"a%d=''" % i for i in range(400_000)) + b"/>",
    "elements at the limit": b'<robot name="r">' + b"<link/>" * 199_000 + b"</robot>",
    "namespaces": b"<robot " + b" ".join(b"xmlns:a%d='u%d'" % (i, i) for i in range(100_000)) + b"/>",
    "long digits": b'<robot name="r"><link name="a"><visual><origin xyz="'
    + b"1" * 4090
    + b'"/></visual></link></robot>',
    "names without end": b'<robot name="r">' + b'<link name="%s"/>' % (b"x" * 9_000_000) * 3 + b"</robot>",
    "near names": b'<robot name="r">'
    + b"".join(b'<link name="%s%d"/>' % (b"ab" * 28, i) for i in range(1000))
    + b'<joint name="j" type="fixed"><parent link="%s"/><child link="q"/></joint></robot>' % (b"ba" * 30),
    "a joint in a ring": joints(999, b"fixed").replace(b'<parent link="l0"/>', b'<parent link="l999"/>'),
    "moving joints": joints(999, b"revolute"),
}


def verdict(path: str, *options: str) -> str:
    def confine() -> None:
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))

    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, path, *options],
        capture_output=True,
        text=True,
        timeout=SECONDS,
        check=False,
        preexec_fn=None if options else confine,  # Pinocchio's libraries alone take more addresses than that
    )
    assert done.returncode == 0, f"{done.returncode}: {done.stderr[-2000:]}"
    assert done.stderr == ""
    return done.stdout


@pytest.mark.parametrize("data", NASTY.values(), ids=NASTY)
def test_nasty_file_is_refused(tmp_path: Path, data: bytes) -> None:
    file = tmp_path / "nasty.urdf"
    file.write_bytes(data)
    assert verdict(str(file)).startswith(f"refused: {file}")


@pytest.mark.parametrize("device", ["/dev/zero", "/dev/stdin"])
def test_device_is_refused(device: str) -> None:
    if not Path(device).exists():
        pytest.skip(f"{device} does not exist here")
    assert verdict(device).startswith(f"refused: {device}")


@pytest.mark.parametrize(("count", "kind", "loaded"), [(999, b"fixed", 1), (150, b"revolute", 151)])
def test_largest_file_that_is_accepted_does_not_harm_pinocchio(
    tmp_path: Path, count: int, kind: bytes, loaded: int
) -> None:
    file = tmp_path / "large.urdf"
    file.write_bytes(joints(count, kind))
    assert verdict(str(file), "--load") == f"accepted: r\nloaded: {loaded}\n"
