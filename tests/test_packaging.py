"""Wheel and source archive: what is in them, and that the wheel runs with its runtime dependencies and nothing else."""

from __future__ import annotations

import importlib.metadata
import json
import os
import re
import subprocess
import sys
import tarfile
import tomllib
import venv
import zipfile
from pathlib import Path

import pytest
import yaml

import nao_kin as nk
from nao_kin.documents.judging import claims

ROOT = Path(__file__).parent.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
LARGEST = 2_000_000  # [bytes]


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the source archive and the wheel that was built from it."""
    folder = tmp_path_factory.mktemp("dist")
    words = [sys.executable, "-m", "build", "--no-isolation", "--outdir", str(folder), str(ROOT)]
    subprocess.run(words, check=True, capture_output=True)
    return folder


@pytest.fixture(scope="module")
def wheel(built: Path) -> Path:
    (found,) = built.glob("*.whl")
    return found


def bare(requirement: str) -> str:
    return re.split(r"[ ;<>=!~\[(]", requirement, maxsplit=1)[0].lower()


def runtime() -> set[str]:
    """The distributions that the runtime dependencies need, directly or not, by name."""
    found: set[str] = set()
    new = {bare(requirement) for requirement in PROJECT["dependencies"]}
    while new:
        found |= new
        needed = [line for name in new for line in importlib.metadata.requires(name) or () if applies(line)]
        new = {bare(line) for line in needed} - found
    return found


def applies(requirement: str) -> bool:
    """Whether a line is installed here: not of an extra, nor of another platform."""
    from packaging.requirements import Requirement

    marker = Requirement(requirement).marker
    return marker is None or marker.evaluate({"extra": ""})


@pytest.fixture(scope="module")
def installed(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The programs of an environment that has the wheel and what it asks for, and nothing else."""
    folder = tmp_path_factory.mktemp("environment")
    venv.create(folder, with_pip=False, symlinks=True)
    (site,) = folder.glob("lib/python*/site-packages")
    for name in runtime():
        distribution = importlib.metadata.distribution(name)
        for top in {Path(file).parts[0] for file in distribution.files or () if not str(file).startswith("..")}:
            if top != "__pycache__" and not (site / top).exists():
                (site / top).symlink_to(Path(str(distribution.locate_file(top))).resolve())
    pip = [sys.executable, "-m", "pip", "--python", str(folder / "bin" / "python"), "install"]
    subprocess.run([*pip, "--quiet", "--no-deps", "--no-index", str(wheel)], check=True, capture_output=True)
    return folder / "bin"


def run(program: Path, *words: str, folder: Path) -> subprocess.CompletedProcess[str]:
    environment = {key: value for key, value in os.environ.items() if key not in ("PYTHONPATH", "VIRTUAL_ENV")}
    return subprocess.run(
        [program, *words], cwd=folder, env=environment, capture_output=True, text=True, check=False, timeout=600
    )


def test_the_wheel_holds_the_robots_the_page_and_the_licence_and_is_small(wheel: Path) -> None:
    names = zipfile.ZipFile(wheel).namelist()
    for file in (ROOT / "urdf").glob("*.urdf"):
        assert f"nao_kin/_data/urdf/{file.name}" in names
    for needed in ("nao_kin/py.typed", "nao_kin/view/page.html", "nao_kin/view/page.css"):
        assert needed in names
    assert any(name.endswith("LICENSE") for name in names)
    assert not any(name.startswith(("tests", "tools", "urdf/", "docs")) for name in names)
    assert wheel.stat().st_size < LARGEST


def test_the_source_archive_has_what_building_and_testing_takes(built: Path) -> None:
    (archive,) = built.glob("*.tar.gz")
    with tarfile.open(archive) as file:
        names = {name.partition("/")[2] for name in file.getnames()}
    for needed in ("pyproject.toml", "README.md", "LICENSE", "Makefile", "tests/conftest.py", "docs/index.md"):
        assert needed in names
    assert not any(name.startswith(("docs/_build", "docs/reference", "demo", ".ci")) for name in names)


def test_nothing_but_the_runtime_dependencies_is_there(installed: Path, tmp_path: Path) -> None:
    code = "import importlib.util as u; print(*(n for n in ('pytest', 'sympy', 'sphinx', 'mypy') if u.find_spec(n)))"
    assert run(installed / "python", "-c", code, folder=tmp_path).stdout.strip() == ""
    code = "import nao_kin as nk; print(nk.__file__); print(nk.load('nao').document.path)"
    done = run(installed / "python", "-c", code, folder=tmp_path)
    assert all(line.startswith(str(installed.parent)) for line in done.stdout.splitlines()), done.stderr


def test_the_installed_demo_runs(installed: Path, tmp_path: Path) -> None:
    done = run(installed / "nao-kin", "demo", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert {path.name for path in (tmp_path / "demo").iterdir()} == {"nao.html", "jaco2.html"}


def test_the_installed_check_and_ledger_run(installed: Path, tmp_path: Path) -> None:
    done = run(installed / "nao-kin", "check", "nao", folder=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    done = run(installed / "nao-kin", "ledger", "--format", "json", folder=tmp_path)
    assert done.returncode == 1, done.stderr  # some statements fail as printed
    assert [row["claim"] for row in json.loads(done.stdout)] == [claim.id for claim in claims()]


def test_the_version_is_the_same_everywhere() -> None:
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert citation["version"] == PROJECT["version"] == nk.__version__
    assert citation["license"] == PROJECT["license"]
