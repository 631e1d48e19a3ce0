"""What a project knows already is not reported again."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from nao_kin.checks.baseline import read_baseline, without_known, write_baseline
from nao_kin.checks.checker import check_bytes
from nao_kin.errors import InvalidInputError

if TYPE_CHECKING:
    from pathlib import Path

ONE = '<robot name="arm">\n  <link name="base"><inertail/></link>\n</robot>\n'


def test_moved_lines_are_known_and_a_second_one_is_new(tmp_path: Path) -> None:
    path = tmp_path / "baseline.json"
    write_baseline(check_bytes(ONE.encode(), "arm.urdf"), path)
    known = read_baseline(path)
    moved = check_bytes(f"<!-- one line more -->\n{ONE}".encode(), "arm.urdf")
    assert len(moved) == 1
    assert without_known(moved, known).findings == ()
    twice = check_bytes(ONE.replace("<inertail/>", "<inertail/>\n<inertail/>").encode(), "arm.urdf")
    assert [finding.line for finding in without_known(twice, known)] == [3]
    other = check_bytes(ONE.encode(), "other.urdf")
    assert len(without_known(other, known)) == 1


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[]",
        "{}",
        '{"layout": 1}',
        '{"layout": 2, "known": []}',
        '{"layout": 1, "known": [1]}',
        *(f'{{"layout": 1, "known": [{{"fingerprint": "a", "count": {n}}}]}}' for n in ("Infinity", "NaN", "1e999")),
    ],
)
def test_another_file_is_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "baseline.json"
    path.write_text(text)
    with pytest.raises(InvalidInputError, match="baseline"):
        read_baseline(path)
