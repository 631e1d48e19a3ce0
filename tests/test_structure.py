"""The house keeps its order: names are used once, rooms are few, and the pictures of the layers are the contract's."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import nao_kin as nk

ROOT = Path(__file__).parent.parent
sys.path.insert(0, str(ROOT / "tools"))

import layers  # noqa: E402
import structure  # noqa: E402

FOUND = structure.modules(ROOT / "src")


def test_no_file_name_is_used_twice() -> None:
    assert structure.twice(module.path.name for module in FOUND if not module.is_package) == []


def test_no_public_class_has_the_name_of_another() -> None:
    assert structure.twice(structure.public_classes(FOUND)) == []


def test_no_module_bears_the_name_of_a_public_function() -> None:
    functions = {name for name in nk.__all__ if name[0].islower()}
    assert functions & {module.path.stem for module in FOUND} == set()


# Rooms whose modules are rows of one table: rules, codes and formats are imported by their list, and by nobody else.
ROWS = ("nao_kin.checks.rules.", "nao_kin.checks.catalogue.", "nao_kin.checks.formats.")


def test_few_modules_have_a_single_importer() -> None:
    assert len([name for name in structure.lone(FOUND) if not name.startswith(ROWS)]) <= 50


def test_few_signatures_are_wide() -> None:
    assert len(structure.wide(FOUND)) <= 10


def test_the_pictures_of_the_layers_are_the_contracts() -> None:
    for page in layers.PAGES:
        text = page.read_text(encoding="utf-8")
        assert layers.with_block(text) == text, f"python tools/layers.py writes {page.name} again"
    assert layers.PICTURE.read_text(encoding="utf-8") == layers.as_svg()


def test_files_that_the_guides_name_exist() -> None:
    for page in (ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))):
        text = page.read_text(encoding="utf-8")
        for name in re.findall(r"`((?:src/nao_kin|tests|tools)/[\w/.]+?\.py)`", text):
            assert (ROOT / name).is_file(), f"{page.name} names {name}"
    text = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    for name in re.findall(r"`([\w/]+(?:\.py|/))`", text):
        assert (ROOT / "src" / "nao_kin" / name).exists(), f"architecture.md names {name}"
