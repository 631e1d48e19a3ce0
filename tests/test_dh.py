"""DH tables: matrices against their definition, units, conventions, files."""

from __future__ import annotations

import dataclasses
import math
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import nao_kin as nk
from nao_kin.dh.dh_row import dh_matrix
from nao_kin.documents.chains import DOCUMENT_CHAINS
from nao_kin.errors import InvalidInputError, TableFileError

if TYPE_CHECKING:
    from pathlib import Path

number = st.floats(-10, 10, allow_subnormal=False)
rows = st.builds(
    nk.DHRow,
    a=number,
    alpha=number,
    d=number,
    theta=number,
    sign=st.sampled_from([1, -1]),
    kind=st.sampled_from(["revolute", "prismatic"]),
    name=st.text(min_size=1, max_size=8).filter(lambda s: s.isprintable()),
    lower=st.just(-math.inf) | st.floats(-5, 0),
    upper=st.just(math.inf) | st.floats(0, 5),
)


def elementary(axis: str, angle: float = 0.0, shift: float = 0.0) -> np.ndarray:
    """A turn about and a shift along one axis, from Pinocchio's exponential."""
    unit = np.eye(3)["xyz".index(axis)]
    return pin.SE3(pin.exp3(unit * angle), unit * shift).homogeneous


@given(row=rows, q=number)
def test_matrices_are_the_products_that_define_the_conventions(row: nk.DHRow, q: float) -> None:
    slide, turn = (row.sign * q, 0.0) if row.kind == "prismatic" else (0.0, row.sign * q)
    z = elementary("z", row.theta + turn, row.d + slide)
    x = elementary("x", row.alpha, row.a)
    np.testing.assert_allclose(dh_matrix(row, q, "standard"), z @ x, atol=1e-13)
    np.testing.assert_allclose(dh_matrix(row, q, "modified"), x @ z, atol=1e-13)


@given(
    table=st.lists(rows, min_size=1, max_size=7, unique_by=lambda row: row.name),
    convention=st.sampled_from(["standard", "modified"]),
)
@settings(max_examples=60, deadline=None)
def test_a_table_survives_its_file_bit_for_bit(tmp_path_factory, table, convention) -> None:
    base, tool = pin.SE3.Random(), pin.SE3.Random()
    chain = nk.DHChain.from_table(table, convention, base=base, tool=tool, name='a "name"\\', tip_name="Ä<b>")
    path = tmp_path_factory.mktemp("t") / "t.toml"
    path.write_text(chain.to_toml(), encoding="utf-8")
    back = nk.DHChain.from_file(path)
    assert back.rows == chain.rows
    assert (back.convention, back.name, back.tip_name) == (chain.convention, chain.name, chain.tip_name)
    np.testing.assert_array_equal(back.base.homogeneous, chain.base.homogeneous)
    np.testing.assert_array_equal(back.tool.homogeneous, chain.tool.homogeneous)


@pytest.mark.parametrize("name", DOCUMENT_CHAINS)
def test_document_chains_survive_their_file(tmp_path: Path, name: str) -> None:
    chain = nk.document_chain(name)
    path = tmp_path / "t.toml"
    path.write_text(chain.to_toml(), encoding="utf-8")
    back = nk.DHChain.from_file(path)
    assert back.rows == chain.rows
    np.testing.assert_array_equal(back.pose(np.ones(len(chain.rows))).homogeneous, chain.pose(np.ones(len(chain.rows))))


def test_units_are_converted_at_the_edge() -> None:
    table = nk.DHChain.from_table(
        [
            (105, -90, 55.95, 30),
            {"a": 0, "alpha": 0, "d": 10, "theta": 0, "kind": "prismatic", "lower": -50, "upper": 50},
        ],
        convention="modified",
        lengths="mm",
        angles="deg",
        base=[[1, 0, 0, 0], [0, 1, 0, 98], [0, 0, 1, 100], [0, 0, 0, 1]],
        tool=pin.SE3(np.eye(3), np.array([0.0, 0.0, 0.25])),
    )
    first, second = table.rows
    assert (first.a, first.alpha, first.d, first.theta) == (0.105, -math.pi / 2, 0.05595, math.pi / 6)
    assert (second.lower, second.upper) == (-0.05, 0.05)
    assert tuple(table.base.translation) == (0.0, 0.098, 0.1)
    assert tuple(table.tool.translation) == (0.0, 0.0, 0.25)  # a pin.SE3 is in metres, whatever the table is in
    with pytest.raises(InvalidInputError, match="DHRow with mm"):
        nk.DHChain.from_table([nk.DHRow(0.1, 0, 0, 0)], "standard", lengths="mm")
    assert table.joint_names == ("joint_1", "joint_2")


def test_the_convention_is_never_a_default() -> None:
    with pytest.raises(TypeError, match="convention"):
        nk.DHChain.from_table([(0, 0, 0, 0)])  # type: ignore[call-arg]
    with pytest.raises(InvalidInputError, match=r"'standard'.*'modified'"):
        nk.DHChain.from_table([(0, 0, 0, 0)], convention="craig")  # type: ignore[arg-type]


def test_reading_a_table_in_the_other_convention_changes_nothing_but_the_convention() -> None:
    table = nk.document_chain("thesis_left_arm")
    other = table.read_as("modified")
    assert other.rows == table.rows
    assert other.convention == "modified"
    assert table.convention == "standard"


@pytest.mark.parametrize(
    ("row", "message"),
    [
        ((0, 0, 0), r"row 1.*\(a, alpha, d, theta\)"),
        ((0, 0, 0, math.nan), "theta.*finite"),
        ((0, math.inf, 0, 0), "alpha.*finite"),
        ((0, 0, 0, 0, 2), "sign.*2"),
        ((0, 0, 0, 0, -1.9), r"row 1, sign.*-1\.9"),
        ((0, 0, 0, 0, True), "sign: expected a number"),
        ("abcd", r"row 1.*\(a, alpha, d, theta\)"),
        ({"a": 0, "alpha": 0, "d": 0, "theta": 0, "max_velocity": -3}, "max_velocity.*> 0"),
        ({"a": 0, "alpha": 0, "d": 0, "theta": 0, "name": 5}, "name: expected text"),
        ({"a": 0, "alpha": 0, "d": 0, "theta": 0, "kind": "continuous", "upper": 3}, "continuous"),
        ({"a": 0, "alpha": 0, "d": 0}, "no theta"),
        ({"a": 0, "alpha": 0, "d": 0, "theta": 0, "twist": 0}, "unknown twist"),
        ({"a": "x", "alpha": 0, "d": 0, "theta": 0}, "a: expected a number"),
        ({"a": 0, "alpha": 0, "d": 0, "theta": 0, "lower": 1, "upper": 0}, "lower ≤ upper"),
        ({"a": 0, "alpha": 0, "d": 0, "theta": 0, "kind": "screw"}, "kind.*screw"),
    ],
)
def test_a_bad_row_is_named(row, message: str) -> None:
    with pytest.raises(InvalidInputError, match=message):
        nk.DHChain.from_table([row], convention="standard")


def test_bad_units_ends_and_empty_tables_are_named() -> None:
    ok = [(0, 0, 0, 0)]
    with pytest.raises(InvalidInputError, match="lengths"):
        nk.DHChain.from_table(ok, "standard", lengths="cm")  # type: ignore[arg-type]
    with pytest.raises(InvalidInputError, match="at least one row"):
        nk.DHChain.from_table([], "standard")
    with pytest.raises(InvalidInputError, match="'j' twice"):
        nk.DHChain.from_table([{"a": 0, "alpha": 0, "d": 0, "theta": 0, "name": "j"}] * 2, "standard")
    with pytest.raises(InvalidInputError, match=r"tool.*violation of 0\.21"):
        nk.DHChain.from_table(ok, "standard", tool=np.diag([1.1, 1.0, 1.0, 1.0]))


GOOD = """name = "arm"
convention = "modified"
lengths = "mm"
angles = "deg"

[base]
xyz = [0, 98, 100]

[[joint]]
name = "one"
a = 0
alpha = -90
d = 0
theta = 0
limits = [-119.5, 119.5]

[[joint]]
a = 15
alpha = 90
d = 105
theta = "180/2"
sign = -1
"""


def from_text(tmp_path: Path, text: str) -> nk.DHChain:
    path = tmp_path / "arm.toml"
    path.write_text(text, encoding="utf-8")
    return nk.DHChain.from_file(path)


def test_a_file_in_millimetres_and_degrees(tmp_path: Path) -> None:
    chain = from_text(tmp_path, GOOD)
    assert chain.rows[1] == nk.DHRow(0.015, math.pi / 2, 0.105, math.pi / 2, sign=-1, name="joint_2")
    assert chain.rows[0].upper == math.radians(119.5)
    assert chain.joint_names == ("one", "joint_2")
    assert tuple(chain.base.translation) == (0.0, 0.098, 0.1)


@pytest.mark.parametrize(
    ("change", "line", "reason"),
    [
        (('convention = "modified"\n', ""), None, "convention is missing"),
        (('"modified"', '"craig"'), 2, "standard or modified"),
        (('"mm"', '"inch"'), 3, "m or mm"),
        (("alpha = -90\n", ""), 9, "alpha missing"),
        (("alpha = 90", 'alpha = "ninety"'), 19, "arithmetic with pi"),
        (("d = 105", "d = nan"), 20, "finite number"),
        (("d = 105", "dd = 105"), 20, "unknown key 'dd'.*did you mean 'd'"),
        (("sign = -1", "sign = 0"), 22, "expected 1 or -1"),
        (("limits = [-119.5, 119.5]", "limits = [1]"), 15, r"\[lower, upper\]"),
        (("limits = [-119.5, 119.5]", "limits = [1, 0]"), 15, "lower is above upper"),
        (("xyz = [0, 98, 100]", "xyz = [0, 98]"), 6, "3 numbers"),
        (("xyz = [0, 98, 100]", "matrix = [[1, 0], [0, 1]]"), 7, "4×4"),
        (("xyz = [0, 98, 100]", "matrix = [[1, 0], [0, 1]]\nxyz = [0, 0, 0]"), 7, "either it or xyz"),
        (("xyz = [0, 98, 100]", "matrix = 5"), 7, "base: 'int' object"),
        (("alpha = 90", 'alpha = "pi/2"'), 19, "radians.*angles = 'deg'"),
        (('name = "one"', "name = 1"), 10, "expected text"),
        (("d = 105", "d = " + "9" * 400), 20, "finite number"),
        (("sign = -1", 'sign = -1\nkind = "continuous"\nlimits = [0, 1]'), 17, "continuous"),
        (('name = "one"', 'name = "joint_2"'), None, "'joint_2' twice"),
        (("lengths =", "lengths"), 3, "not TOML"),
        (('theta = "180/2"', 'theta = "1/0"'), 21, "finite number"),
        (('theta = "180/2"', "theta = \"__import__('os')\""), 21, "arithmetic with pi"),
        (("a = 15", "a = true"), 18, "finite number"),
    ],
)
def test_a_bad_file_names_the_line_and_what_was_expected(tmp_path: Path, change, line, reason: str) -> None:
    assert change[0] in GOOD
    with pytest.raises(TableFileError, match=reason) as caught:
        from_text(tmp_path, GOOD.replace(*change, 1))
    assert caught.value.line == line


def test_files_that_are_no_tables(tmp_path: Path) -> None:
    with pytest.raises(TableFileError, match="no such file"):
        nk.DHChain.from_file(tmp_path / "nothing.toml")
    with pytest.raises(TableFileError, match="not a regular file"):
        nk.DHChain.from_file(tmp_path)
    (tmp_path / "b.toml").write_bytes(b"\xff\xfe")
    with pytest.raises(TableFileError, match="not UTF-8"):
        nk.DHChain.from_file(tmp_path / "b.toml")
    (tmp_path / "big.toml").write_bytes(b"#" * (1 << 21))
    with pytest.raises(TableFileError, match="larger than"):
        nk.DHChain.from_file(tmp_path / "big.toml")
    with pytest.raises(TableFileError, match="nested too deeply"):
        from_text(tmp_path, "x = " + "[" * 5000)
    assert from_text(tmp_path, "\ufeff" + GOOD).name == "arm"
    with pytest.raises(TableFileError, match=r"\[\[joint\]\]"):
        from_text(tmp_path, 'convention = "standard"\n')


def test_the_constants_of_the_documents_are_their_own() -> None:
    """Bischoff's Table 2 prints 55.98 for the lower arm, and the oblique wrist of the JACO2 has documented lengths."""
    reach = nk.document_chain("thesis_left_arm").tool.translation
    np.testing.assert_allclose(np.linalg.norm(reach), 0.05775 + 0.05598, atol=1e-15)
    d4, d5, d6 = (row.d for row in nk.document_chain("practicum_jaco2").rows[3:])
    np.testing.assert_allclose((-d4, -d5, -d6), (0.250082, 0.085563, 0.202782), atol=5e-7)


def test_rows_and_chains_cannot_be_changed() -> None:
    chain = nk.document_chain("kofinas_head")
    with pytest.raises(dataclasses.FrozenInstanceError):
        chain.name = "x"  # type: ignore[misc]
    with pytest.raises(dataclasses.FrozenInstanceError):
        chain.rows[0].a = 1.0  # type: ignore[misc]
