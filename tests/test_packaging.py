"""The built wheel, installed on its own, finds the robots and runs."""

from __future__ import annotations

import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    subprocess.run(
        [sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", str(folder), str(ROOT)],
        check=True,
        capture_output=True,
    )
    (found,) = folder.glob("*.whl")
    return found


def test_the_wheel_holds_the_robots_the_page_and_the_licence(wheel: Path) -> None:
    names = zipfile.ZipFile(wheel).namelist()
    for file in (ROOT / "urdf").glob("*.urdf"):
        assert f"nao_kin/_data/urdf/{file.name}" in names
    for needed in ("nao_kin/py.typed", "nao_kin/view/page.html", "nao_kin/view/page.js", "nao_kin/view/page.css"):
        assert needed in names
    assert any(name.endswith("LICENSE") for name in names)
    assert not any(name.startswith(("tests", "tools", "urdf/")) for name in names)


def test_the_installed_wheel_runs_away_from_the_checkout(wheel: Path, tmp_path: Path) -> None:
    site = tmp_path / "site"
    subprocess.run(
        [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--target", str(site), str(wheel)],
        check=True,
        capture_output=True,
    )
    code = (
        f"import sys; sys.path.insert(0, {str(site)!r}); import nao_kin as nk; assert {str(site)!r} in nk.__file__;"
        "r = nk.load('nao'); print(r.document.path); nk.export_html('nao.html', r)"
    )
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(str(site))
