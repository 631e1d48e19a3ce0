"""The documentation builds: no warning, no reference that leads nowhere, every public name on a page."""

from __future__ import annotations

import os
import subprocess
import sys
import zlib
from pathlib import Path

import pytest

import nao_kin as nk
from nao_kin.checks.catalogue import CATALOGUE
from tests.conftest import needs

ROOT = Path(__file__).parent.parent


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    needs("furo")
    folder = tmp_path_factory.mktemp("site")
    words = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-n", "-q", "-E", "-b", "html"]
    command = [*words, "-d", str(folder / "doctrees"), str(ROOT / "docs"), str(folder / "html")]
    environment = os.environ | {"PYTHONWARNINGS": "ignore"}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return folder / "html"


def test_every_public_name_is_on_a_page(site: Path) -> None:
    header, _, packed = (site / "objects.inv").read_bytes().partition(b"zlib.\n")
    assert b"Sphinx inventory" in header
    listed = {line.split()[0].decode() for line in zlib.decompress(packed).splitlines()}
    assert {f"nao_kin.{name}" for name in nk.__all__} <= listed


def test_every_code_and_every_claim_is_on_a_page(site: Path) -> None:
    codes = (site / "reference" / "codes.html").read_text(encoding="utf-8")
    assert all(f'id="{code}"' in codes for code in CATALOGUE)
    sheet = (site / "reference" / "errata.html").read_text(encoding="utf-8")
    assert all(document in sheet for document in ("000:", "001:", "002:", "004:"))


def test_nothing_is_left_in_the_checkout_but_what_git_ignores(site: Path) -> None:
    ignored = (ROOT / ".gitignore").read_text(encoding="utf-8").split()
    assert {"/docs/_build/", "/docs/reference/"} <= set(ignored)
