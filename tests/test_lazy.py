"""What a command does not need it does not import."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import nao_kin as nk

HEAVY = ("numpy", "pinocchio", "numba", "meshcat", "trimesh", "yourdfpy", "lxml", "typer", "rich")


def imported_by(code: str) -> set[str]:
    report = f"import sys\n{code}\nprint(*(m for m in {HEAVY!r} if m in sys.modules))"
    done = subprocess.run([sys.executable, "-c", report], capture_output=True, text=True, check=True)
    return set(done.stdout.splitlines()[-1].split())


def test_importing_the_package_imports_nothing_heavy() -> None:
    assert imported_by("import nao_kin") == set()


@pytest.mark.parametrize(
    ("arguments", "without"),
    [
        (["robots"], {"numpy", "pinocchio", "numba", "meshcat", "trimesh", "yourdfpy", "lxml"}),
        (["fk", "jaco2"], {"numba", "meshcat", "trimesh", "yourdfpy"}),
        (["compare", "kofinas_head"], {"numba", "meshcat", "trimesh", "yourdfpy"}),
        (["check", "nao"], {"numba", "meshcat", "trimesh", "yourdfpy", "rich"}),
        (["check", "tests/corpus/zero-axis.urdf"], {"pinocchio", "numba", "meshcat", "trimesh", "yourdfpy"}),
        (["explain", "zero-axis"], {"numpy", "pinocchio", "numba", "meshcat", "trimesh", "yourdfpy"}),
    ],
)
def test_commands_import_what_they_need_only(arguments: list[str], without: set[str]) -> None:
    code = (
        f"from nao_kin.cli.app import application\napplication({arguments[:1]!r})({arguments!r}, standalone_mode=False)"
    )
    assert imported_by(code).isdisjoint(without)


def test_trimesh_is_imported_for_a_mesh_and_yourdfpy_for_a_second_opinion() -> None:
    code = "import nao_kin as nk; nk.check('tests/corpus/{}.urdf', thorough={})"
    assert imported_by(code.format("mesh-unit", False)) & {"trimesh", "yourdfpy"} == {"trimesh"}
    assert "yourdfpy" in imported_by(code.format("mesh-unit.passes", True))


def test_every_public_name_resolves_and_is_listed() -> None:
    for name in nk.__all__:
        assert getattr(nk, name) is not None
        assert name in dir(nk)
    with pytest.raises(AttributeError, match="no_such_thing"):
        nk.no_such_thing  # noqa: B018


def test_no_module_bears_the_name_of_a_public_function() -> None:
    """A lazy nk.compare beside a module nao_kin/compare.py would break on the module's first import."""
    modules = {path.stem for path in Path(nk.__file__).parent.iterdir()}
    assert modules.isdisjoint(nk.__all__)
