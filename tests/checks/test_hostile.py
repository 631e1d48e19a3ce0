"""Hostile files through the whole check, in a guarded process: a verdict on each, within bounded memory and time."""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest
from tests.urdf.test_crash_guard import BOMB, NASTY, joints

import nao_kin as nk
from nao_kin.checks.checker import MOST_OF_A_CODE, check_bytes
from nao_kin.checks.formats.machine import as_github, as_junit, as_sarif
from nao_kin.checks.formats.text import as_text

if TYPE_CHECKING:
    from pathlib import Path

PROGRAM = """
import json, socket, sys
from pathlib import Path
def refuse(*arguments, **options):
    raise SystemExit("a file has reached for the network")
socket.socket.connect = refuse
from nao_kin.checks.checker import check
for path in sys.argv[1:]:
    print(json.dumps([Path(path).name, list(check(path).codes)]), flush=True)
"""
MEMORY = 2 * 1024**3
SECONDS = 300  # a guard against hanging, not a measure of speed

HEAD = b'<robot name="r"><link name="a"/>'
MORE_NASTY = {
    "100 000 links": b'<robot name="r">' + b"".join(b'<link name="l%d"/>' % i for i in range(100_000)) + b"</robot>",
    "1000 links without joints": b'<robot name="r">'
    + b"".join(b'<link name="l%d"/>' % i for i in range(1000))
    + b"</robot>",
    "UTF-16": (HEAD + b"</robot>").decode().encode("utf-16"),
    "truncated": joints(100, b"revolute")[:7001],
    "huge numbers": joints(5, b"prismatic").replace(b'lower="-1"', b'lower="-%s"' % (b"9" * 308)),
    "many digits": joints(5, b"prismatic").replace(b'lower="-1"', b'lower="-0.%s"' % (b"9" * 4000)),
    "NaN": joints(5, b"revolute").replace(b'lower="-1"', b'lower="nan"'),
    "markup as names": joints(3, b"revolute")
    .replace(b'"l1"', b'"&lt;script&gt;alert(1)&lt;/script&gt;"')
    .replace(b'"l2"', b'"__proto__"'),
    "defects everywhere": b'<robot name="r">' + b'<link name="a" a="1"><b/><inertail/></link>' * 900 + b"</robot>",
    "misspelt names": b'<robot name="r">'
    + b"".join(b'<link name="%s%d"/>' % (b"ab" * 28, i) for i in range(1000))
    + b"".join(
        b'<joint name="j%d" type="fixed"><parent link="%s%d"/><child link="%s%d"/></joint>'
        % (i, b"ba" * 28, i, b"bb" * 28, i)
        for i in range(900)
    )
    + b"</robot>",
    "words like ours": HEAD + b"".join(b"<jo%dint/>" % i for i in range(20_000)) + b"</robot>",
    "quotes in text": HEAD + b"='\"" * 100_000 + b"</robot>",
    "devices as meshes": HEAD[:-2]
    + b"><visual><geometry>"
    + b"".join(
        b'<mesh filename="%s"/>' % name
        for name in (b"/dev/zero", b"file:///dev/stdin", b"package://../../dev/zero.stl", b"//dev/zero.stl")
    )
    + b"</geometry></visual></link></robot>",
    "included file": HEAD
    + b'<xi:include xmlns:xi="http://www.w3.org/2001/XInclude" href="/etc/passwd" parse="text"/></robot>',
    "stylesheet": b'<?xml-stylesheet href="http://127.0.0.1:1/x.xsl"?>' + HEAD + b"</robot>",
    "remote entity": b'<!DOCTYPE r SYSTEM "http://127.0.0.1:1/x.dtd">' + HEAD + b"</robot>",
    "bomb behind a comment": b"<!-- -->" + BOMB + HEAD + b"</robot>",
}


def test_every_hostile_file_gets_a_verdict(tmp_path: Path) -> None:
    files = {}
    for number, (name, data) in enumerate({**NASTY, **MORE_NASTY}.items()):
        files[f"{number}.urdf"] = name
        (tmp_path / f"{number}.urdf").write_bytes(data)

    def confine() -> None:
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))

    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, *(str(tmp_path / name) for name in files)],
        capture_output=True,
        text=True,
        timeout=SECONDS,
        check=False,
        preexec_fn=confine,
        env=os.environ | {"OPENBLAS_NUM_THREADS": "1"},
    )
    verdicts = dict(map(json.loads, done.stdout.splitlines()))
    assert done.returncode == 0, f"{files.get(f'{len(verdicts)}.urdf')}: {done.stderr[-2000:]}"
    assert verdicts.keys() == files.keys()
    harmless = {"markup as names", "many digits", "quotes in text", "included file", "stylesheet"}
    for name, codes in verdicts.items():
        assert codes or files[name] in harmless, files[name]
    named = {files[name]: set(codes) for name, codes in verdicts.items()}
    assert named["100 000 links"] == {"too-many"}
    assert named["UTF-16"] == {"not-utf8"}
    assert named["truncated"] == {"not-well-formed"}
    assert named["NaN"] >= {"not-finite"}
    assert named["entity bomb in text"] == named["remote entity"] == named["bomb behind a comment"] == {"doctype"}
    assert "root:" not in done.stdout


def test_a_file_full_of_defects_lists_a_bounded_number_and_says_so() -> None:
    report = check_bytes(MORE_NASTY["defects everywhere"], "full.urdf")
    counts = {code: sum(finding.code == code for finding in report) for code in report.codes}
    assert max(counts.values()) == MOST_OF_A_CODE
    assert ("full.urdf", "unknown-attribute") in report.incomplete
    assert "More findings of unknown-attribute" in as_text(report)


def test_markup_in_names_stays_text_in_every_format() -> None:
    data = MORE_NASTY["markup as names"].replace(b'type="revolute"', b'type="<x>"'.replace(b"<", b"&lt;"))
    report = check_bytes(data, "names.urdf")
    assert report.errors
    assert "<script>" not in report._repr_html_()
    assert "<script>" not in as_junit(report)
    assert "\n" not in as_github(report).split("\n", maxsplit=1)[0]
    assert json.loads(json.dumps(as_sarif(report)))


@pytest.mark.parametrize("path", ["/dev/zero", "/", "/no/such.urdf"])
def test_what_cannot_be_read_at_all_is_an_error_not_a_finding(path: str) -> None:
    with pytest.raises(nk.NaoKinError) as caught:
        nk.check(path)
    assert caught.value.code == "unreadable"  # type: ignore[attr-defined]
