"""Macros are code: what they may not have is refused, and takes neither long nor much."""

from __future__ import annotations

import time
from typing import TYPE_CHECKING

import pytest

import nao_kin as nk
from nao_kin.urdf.xacro_guard import RefusedExpressionError, check_expression

if TYPE_CHECKING:
    from pathlib import Path

HEAD = '<robot name="a" xmlns:xacro="http://www.ros.org/wiki/xacro">\n<link name="b"/>\n'
ESCAPE = "[c for c in ().__class__.__base__.__subclasses__()]"
FRAME = "(x for x in [1]).gi_frame.f_builtins"
DOUBLE = "".join(f'<xacro:macro name="m{i}"><xacro:m{i - 1}/><xacro:m{i - 1}/></xacro:macro>' for i in range(1, 40))

HOSTILE = {
    "classes by attributes": f'<link name="${{{ESCAPE}}}"/>',
    "classes inside a comprehension": '<link name="${[x.__class__ for x in [1]]}"/>',
    "the frame of a generator": f'<link name="${{{FRAME}}}"/>',
    "attributes by a format": "<link name=\"${'{0.__class__}'.format(1)}\"/>",
    "a function": '<link name="${(lambda: 1)()}"/>',
    "a shell by eval": "<link name=\"$(eval __import__('os').system('id'))\"/>",
    "an absolute include": '<xacro:include filename="/etc/passwd"/>',
    "an include upwards": '<xacro:include filename="../../../../../../etc/passwd"/>',
    "an include by a link": '<xacro:include filename="link.xacro"/>',
    "an include by stars": '<xacro:include filename="/etc/pass*"/>',
    "a YAML file elsewhere": "<link name=\"${xacro.load_yaml('/etc/hostname')}\"/>",
    "an entity of an included file": '<xacro:include filename="entity.xacro"/>',
    "a macro without an end": '<xacro:macro name="m"><xacro:m/></xacro:macro><xacro:m/>',
    "an include of itself": '<xacro:include filename="arm.xacro"/>',
    "a number without an end": '<link name="${9**9**9}"/>',
    "text without an end": "<link name=\"${'x' * 10**11}\"/>",
    "a list without an end": '<link name="${[x for x in python.range(10**12)]}"/>',
    "macros that double": f'<xacro:macro name="m0"><link name="x"/></xacro:macro>{DOUBLE}<xacro:m39/>',
}

# Refused before anybody asks: no XML that is read, and no expressions, because xacro ends them at the first bracket.
NOT_EVEN_READ = ("an entity of an included file", "attributes by a format", "a shell by eval")


@pytest.mark.parametrize("inside", HOSTILE.values(), ids=HOSTILE)
def test_it_is_refused(inside: str, tmp_path: Path) -> None:
    folder = tmp_path / "below" / "macros"
    folder.mkdir(parents=True)
    (folder / "entity.xacro").write_text('<!DOCTYPE robot [<!ENTITY x SYSTEM "/etc/passwd">]><robot>&x;</robot>')
    (folder / "link.xacro").symlink_to("/etc/passwd")
    path = folder / "arm.xacro"
    path.write_text(f"{HEAD}{inside}\n</robot>")
    start = time.monotonic()
    report = nk.check(path)
    assert report.codes in {("xacro-refused",), ("xacro-failed",)}, report
    assert time.monotonic() - start < 60.0
    assert "root:" not in str(report.findings)
    if inside not in {HOSTILE[name] for name in NOT_EVEN_READ}:
        assert report.codes == ("xacro-refused",)


def test_the_environment_is_not_seen(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SECRET", "word")
    path = tmp_path / "arm.xacro"
    for text in ("$(env SECRET)", "x$(env SECRET)"):
        path.write_text(f'{HEAD}<link name="{text}"/></robot>')
        (finding,) = nk.check(path)
        assert "not given to files" in finding.message
        assert "word" not in finding.message
    path.write_text(f'{HEAD}<joint name="j" type="fixed"><parent link="b"/><child link="c"/></joint>'
                    '<link name="$(optenv SECRET c)"/></robot>')  # fmt: skip
    assert nk.load(path).frame_names == ("b", "c")


def test_nothing_is_written_by_macros_and_nothing_printed(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "arm.xacro"
    path.write_text(f"{HEAD}<!-- ${{xacro.message('hello')}} --><link name=\"${{xacro.warning('x')}}c\"/></robot>")
    nk.check(path)
    assert [file.name for file in tmp_path.iterdir()] == ["arm.xacro"]
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    "text",
    [
        "1 + 2 * pi",
        "limits['elbow'].lower if side == 'l' else -limits.elbow.upper",
        "' '.join([str(x) for x in [1, 2]])",
        "xacro.load_yaml(file)['a'][0]",
        "dict(a=1, **b)",
        "not (a and b) or c in [1, 2]",
        "f'{a}_{b}'",
        "python.sorted(d.items())",
        "max(map(float, names))",
    ],
)
def test_expressions_of_real_macros_are_evaluated(text: str) -> None:
    check_expression(text)


@pytest.mark.parametrize(
    "text", ["a.__class__", "__import__('os')", "(x for x in y).gi_frame", "a._b", "x.mro()", "(a := 1)", "lambda: 1",
             "f.f_globals", "'{}'.format(1)", "f.func_globals", "x" * 5000]
)  # fmt: skip
def test_expressions_that_lead_out_are_not(text: str) -> None:
    with pytest.raises(RefusedExpressionError):
        check_expression(text)
