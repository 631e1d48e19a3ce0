"""Trajectory files: nothing is lost on the way, and what is wrong is named with its line and column."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path

import numpy as np
import pytest

import nao_kin as nk
from nao_kin.errors import InvalidInputError, TrajectoryFileError
from nao_kin.trajectory.files import reading as files
from nao_kin.trajectory.files.reading import format_trajectory, parse_trajectory, read_trajectory, write_trajectory
from nao_kin.trajectory.trajectory import Trajectory
from tests.conftest import robot

FORMS = ("txt", "csv", "json")


def awkward(seed: int = 0, count: int = 100) -> Trajectory:
    """Numbers of every size, and names that a careless writer would spoil."""
    rng = np.random.default_rng(seed)
    joints = [
        *robot("jaco2").chain("arm").joints,
        nk.ChainJoint('odd, "name" [x] # 1', "prismatic", -1.0, 2.0 / 3.0),
        nk.ChainJoint("Größe", lower=-math.pi),
    ]
    q = rng.normal(size=(count, 8)) * 10.0 ** rng.integers(-307, 307, (count, 8))
    q[0] = [0.0, -0.0, 5e-324, 1.7976931348623157e308, -math.pi, 0.1, 1 / 3, 1e22]
    return Trajectory(joints, np.cumsum(rng.uniform(1e-9, 1.0, count)) - 3.0, q, 'a "name",\nin two lines')


@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("seed", range(3))
def test_every_bit_survives(form: str, seed: int, tmp_path: Path) -> None:
    given = awkward(seed)
    found = read_trajectory(write_trajectory(tmp_path / f"motion.{form.upper()}", given))
    assert found.times.tobytes() == given.times.tobytes()
    assert found.q.tobytes() == given.q.tobytes()
    assert found.joints == given.joints
    assert found.name == given.name
    assert format_trajectory(found, form) == format_trajectory(given, form)


def test_a_path_written_and_read_back_runs_the_same(tmp_path: Path) -> None:
    """Practicum, tasks 2d and 2g."""
    arm = robot("jaco2").chain("arm")
    q0 = np.radians([180, 200, 120, 100, 80, 30])
    T = arm.pose(q0)
    path = nk.timed(nk.PositionLine(T.translation, T.translation - [0, 0, 0.2]), speed=0.2, acceleration=0.5)
    found = nk.follow(arm, path, q0, scale=True)
    assert found.trajectory is not None
    again = read_trajectory(write_trajectory(tmp_path / "line.txt", found.trajectory))
    assert again.q.tobytes() == found.q.tobytes()
    np.testing.assert_array_equal(arm.poses(again.q), arm.poses(found.q))


def test_a_numpy_or_matlab_reader_finds_the_numbers(tmp_path: Path) -> None:
    given = awkward()
    for form, between in (("txt", None), ("csv", ",")):
        path = write_trajectory(tmp_path / f"motion.{form}", given)
        skipped = sum(not line[:1].isdigit() and line[:1] != "-" for line in path.read_text("utf-8").splitlines())
        numbers = np.loadtxt(path, delimiter=between, skiprows=skipped, encoding="utf-8")
        np.testing.assert_array_equal(numbers[:, 1:], given.q)


def test_files_by_other_hands() -> None:
    txt = parse_trajectory("# time [s], a [rad], b [m]\n\n0 1 2\n0.5  -1e-3 .5  \r\n# a word\n1. 3 4\n", "txt")
    assert [(joint.name, joint.kind) for joint in txt.joints] == [("a", "revolute"), ("b", "prismatic")]
    np.testing.assert_array_equal(txt.q, [[1, 2], [-1e-3, 0.5], [3, 4]])
    csv = parse_trajectory('time [s],"a, left [rad]"\n0,1\n1, 2\n', "csv")
    assert csv.joint_names == ("a, left",)


GOOD = {
    "txt": '# nao_kin trajectory, format 1\n# joint: {"name": "a", "kind": "revolute", "unit": "rad"}\n'
    "# time [s], a [rad]\n0.0 1.0\n0.5 2.0\n1.0 3.0\n",
    "csv": "time [s],a [rad]\n0.0,1.0\n0.5,2.0\n1.0,3.0\n",
    "json": '{"format": "nao_kin trajectory, format 1",\n'
    '"joints": [{"name": "a", "kind": "revolute", "unit": "rad"}],\n'
    '"samples": [\n[0.0, 1.0],\n[0.5, 2.0],\n[1.0, 3.0]]}\n',
}

BAD = [
    ("txt", "0.5 2.0", "0.5 nan", 5, 2, "finite number, got 'nan'"),
    ("txt", "0.5 2.0", "0.5 inf", 5, 2, "finite number"),
    ("txt", "0.5 2.0", "0.5 1e999", 5, 2, "finite number"),
    ("txt", "0.5 2.0", "0.5 1_0", 5, 2, "finite number, got '1_0'"),
    ("txt", "0.5 2.0", "0.5 ٣", 5, 2, "finite number"),
    ("txt", "0.5 2.0", "0.5 2,0", 5, 2, "finite number, got '2,0'"),
    ("txt", "0.5 2.0", "0.5", 5, None, r"expected 2 numbers, got 1. a \[rad\] is missing"),
    ("txt", "0.5 2.0", "0.5 2.0 3.0", 5, None, "expected 2 numbers, got 3"),
    ("txt", "1.0 3.0", "0.5 3.0", 6, 1, "more than 0.5 s, the time of line 5"),
    ("txt", "1.0 3.0", "0.4 3.0", 6, 1, "got 0.4 s"),
    ("txt", "a [rad]\n0", "a [deg]\n0", 3, 2, r"expected 'a \[rad\]' as the joints above say"),
    ("txt", "time [s]", "time [ms]", 3, 1, r"expected 'time \[s\]'"),
    ("txt", "# time [s], a [rad]\n", "", 3, None, "column headings before the first row"),
    ("txt", "a [rad]\n0", "a [rad], b [rad]\n0", 3, 3, "expected 'no more'"),
    ("txt", '"rad"', '"deg"', 2, None, "is in rad, not in 'deg'"),
    ("txt", '"revolute"', '"revolut"', 2, None, "expected the kind"),
    ("txt", '"unit"', '"units"', 2, None, "Did you mean 'unit'"),
    ("txt", '"rad"}', '"rad", "lower": 2, "upper": 1}', 2, None, "lower ≤ upper"),
    ("txt", '"rad"}', '"rad", "max_velocity": NaN}', 2, None, "max_velocity: expected a finite number"),
    ("txt", '"rad"}', '"rad"', 2, None, "expected JSON"),
    ("txt", "format 1", "format 2", 1, None, "format 1"),
    ("txt", "0.0 1.0\n0.5 2.0\n1.0 3.0\n", "", None, None, "at least one sample"),
    ("csv", "0.5,2.0", "0.5,NaN", 3, 2, "finite number"),
    ("csv", "0.5,2.0", "0.5,", 3, 2, "finite number, got ''"),
    ("csv", "0.5,2.0", "0.5;2.0", 3, None, "expected 2 numbers, got 1"),
    ("csv", "1.0,3.0", "0.1,3.0", 4, 1, "more than 0.5 s"),
    ("csv", "a [rad]", "a [deg]", 1, 2, "Convert degrees"),
    ("csv", "a [rad]", "a", 1, 2, "expected NAME"),
    ("csv", "a [rad]", "a [rad],a [m]", 1, 2, "'a' occurs twice"),
    ("csv", "time [s],a [rad]", "time [s]", 1, None, "at least one joint"),
    ("csv", "a [rad]", "a\rb [rad]", 1, None, "column headings"),
    ("csv", "a [rad]", "a" * 200_000 + " [rad]", 1, None, "column headings"),
    ("csv", "a [rad]", '"a [rad]', 1, None, "column headings"),
    ("txt", "0.5 2.0", f"0.5 {'1' * 200_000}x", 5, 2, "finite number"),
    ("json", "2.0", "NaN", 5, 2, "finite number, got nan"),
    ("json", "2.0", "1" + "0" * 400, 5, 2, "finite number"),
    ("json", "2.0", "true", 5, 2, "finite number, got True"),
    ("json", "2.0", '"2.0"', 5, 2, "finite number, got '2.0'"),
    ("json", "[0.5, 2.0]", "[0.5]", 5, None, "expected 2 numbers, got 1"),
    ("json", "[0.5, 2.0]", "{}", 5, None, "expected 2 numbers"),
    ("json", "[1.0, 3.0]", "[0.5, 3.0]", 6, 1, "more than 0.5 s"),
    ("json", "[1.0, 3.0]]", "[1.0, 3.0", 6, None, "not JSON"),
    ("json", '"joints"', '"joint"', None, None, "Did you mean 'joints'"),
    ("json", '"samples"', '"joints"', None, None, "occurs twice"),
    ("json", "format 1", "format 9", None, None, "format"),
    ("json", '"rad"', '"deg"', None, None, "is in rad, not in 'deg'"),
    ("json", "2.0", "1" * 5000, None, None, "too many digits"),
    ("json", GOOD["json"], "[" * 100_000, None, None, "deeply"),
    ("json", GOOD["json"], "[]", None, None, "object"),
]


@pytest.mark.parametrize("form", FORMS)
def test_the_files_to_be_spoilt_are_good(form: str) -> None:
    np.testing.assert_array_equal(parse_trajectory(GOOD[form], form).q, [[1], [2], [3]])


@pytest.mark.parametrize(("form", "old", "new", "line", "column", "said"), BAD)
def test_what_is_wrong_is_named_with_its_place(
    form: str, old: str, new: str, line: int | None, column: int | None, said: str
) -> None:
    spoilt = GOOD[form].replace(old, new, 1)
    assert spoilt != GOOD[form]
    with pytest.raises(TrajectoryFileError, match=said) as caught:
        parse_trajectory(spoilt, form, "motion.file")
    assert (caught.value.line, caught.value.column) == (line, column)
    assert str(caught.value).startswith("motion.file" if line is None else f"motion.file:{line}: ")


def test_files_that_are_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(TrajectoryFileError, match="no such file"):
        read_trajectory(tmp_path / "a.txt")
    (tmp_path / "folder.txt").mkdir()
    with pytest.raises(TrajectoryFileError, match="not a regular file"):
        read_trajectory(tmp_path / "folder.txt")
    (tmp_path / "bytes.txt").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(TrajectoryFileError, match="UTF-8"):
        read_trajectory(tmp_path / "bytes.txt")
    for bad in ("motion.urdf", "motion"):
        with pytest.raises(InvalidInputError, match=r"\.txt, \.csv or \.json"):
            read_trajectory(tmp_path / bad)
        with pytest.raises(InvalidInputError, match=r"\.txt, \.csv or \.json"):
            write_trajectory(tmp_path / bad, awkward())
    with pytest.raises(InvalidInputError, match="txt, csv or json"):
        parse_trajectory("", "yaml")
    monkeypatch.setattr(files, "LARGEST_FILE", 10)
    (tmp_path / "large.txt").write_text(GOOD["txt"])
    with pytest.raises(TrajectoryFileError, match="larger than 10 bytes"):
        read_trajectory(tmp_path / "large.txt")


def test_a_name_that_no_line_holds_is_refused_before_the_file_is_touched(tmp_path: Path) -> None:
    broken = Trajectory(["two\nlines"], [0.0], [[1.0]])
    path = tmp_path / "kept.txt"
    path.write_text("kept")
    with pytest.raises(InvalidInputError, match="fits on a line"):
        write_trajectory(path, broken)
    assert path.read_text() == "kept"
    found = read_trajectory(write_trajectory(tmp_path / "motion.json", broken))
    assert found.joint_names == ("two\nlines",)


@pytest.mark.parametrize("form", FORMS)
def test_random_damage_is_refused_or_read_but_never_more(form: str) -> None:
    """Cut, swapped and repeated bytes: an error of this package, or a trajectory that holds what the text says."""
    rng, text = np.random.default_rng(5), format_trajectory(awkward(1, 5), form)
    for _ in range(300):
        at, until = np.sort(rng.integers(0, len(text), 2))
        piece = rng.choice(["", text[at:until][::-1], text[at:until] * 2, "\0", "nan", ","])
        spoilt = text[:at] + str(piece) + text[until:]
        try:
            found = parse_trajectory(spoilt, form)
        except (TrajectoryFileError, InvalidInputError):
            continue
        assert np.isfinite(found.q).all()
        assert (np.diff(found.times) > 0).all()


def test_the_documented_files_are_read() -> None:
    page = (Path(__file__).parent.parent.parent / "docs" / "trajectory-files.md").read_text(encoding="utf-8")
    plain, full, message = re.findall(r"```text\n(.*?)```", page, flags=re.DOTALL)
    np.testing.assert_array_equal(parse_trajectory(plain, "txt").q[0], [math.pi, 3.490658503988659])
    found = parse_trajectory(full, "txt")
    assert (found.name, found.joints[0].max_velocity) == ("line", 0.6283185307179586)
    with pytest.raises(TrajectoryFileError) as caught:
        parse_trajectory(plain.replace("\n", "\n\n\n\n\n", 1).replace("3.490658503988659", "nan"), "txt", "line.txt")
    assert str(caught.value).split(":", 2)[2] == message.strip().split(":", 2)[2]
    assert f"{files.LARGEST_FILE >> 20} MiB" in page


def test_the_json_is_json() -> None:
    data = json.loads(format_trajectory(awkward(), "json"))
    assert set(data) == {"format", "name", "columns", "joints", "samples"}
    assert len(data["samples"]) == 100
