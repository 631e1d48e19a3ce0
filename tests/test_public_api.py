"""Every public name says what it is, in which shapes, units and frames, and what it raises; types hold for a user."""

from __future__ import annotations

import ast
import dataclasses
import inspect
import os
import re
import subprocess
import sys
import textwrap
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import pytest

import nao_kin as nk

ROOT = Path(__file__).parent.parent
SHAPE = re.compile(r"\((?:[\w…]+|[\w…]+ [+−] [\w…]+),(?: ?[\w… +−]+,?)*\)")
UNIT = re.compile(r"\[[^\]]+\]|0 … 1|a plain ")  # or said to have none
FRAME = re.compile(r"T_\w+_\w+|base|frame")
WITHOUT_UNIT = {
    ("ReachMap", "greatest"): "the measure that was chosen has its own",
    ("ReachMap", "mean"): "the measure that was chosen has its own",
}


class Described(NamedTuple):
    """A public function, method or property with its docstring."""

    name: str
    function: Any
    is_method: bool

    @property
    def text(self) -> str:
        return inspect.getdoc(self.function) or ""

    @property
    def parameters(self) -> list[inspect.Parameter]:
        found = inspect.signature(self.function).parameters.values()
        return [p for p in found if p.name not in ("self", "cls")]

    @property
    def returned(self) -> str:
        return str(inspect.signature(self.function).return_annotation)


def plain(member: Any) -> Any:
    """The function behind a property, class method or static method; None for anything else."""
    if isinstance(member, property):
        member = member.fget
    elif isinstance(member, cached_property):
        member = member.func
    elif isinstance(member, classmethod | staticmethod):
        member = member.__func__
    return inspect.unwrap(member) if inspect.isfunction(member) else None


def described() -> list[Described]:
    found = []
    for name in sorted(nk.__all__):
        value = getattr(nk, name)
        if inspect.isclass(value):
            members = {key: plain(member) for key, member in vars(value).items() if not key.startswith("_")}
            found += [Described(f"{name}.{key}", member, True) for key, member in members.items() if member]
        elif callable(value):
            found.append(Described(name, inspect.unwrap(value), False))
    return found


EVERYTHING = described()
CLASSES = [name for name in sorted(nk.__all__) if inspect.isclass(getattr(nk, name))]
RECORDS = [name for name in CLASSES if dataclasses.is_dataclass(getattr(nk, name))]


def listed(text: str, section: str) -> dict[str, str]:
    """The entries of a section of a docstring in Google style, by name."""
    match = re.search(rf"^{section}:\n((?:[ ].*\n?|\n)*)", text, flags=re.MULTILINE)
    found: dict[str, str] = {}
    for line in match[1].splitlines() if match else ():
        entry = re.match(r"    \*{0,2}(\w+(?:, \w+)*):(.*)", line)
        if entry:
            names = entry[1].split(", ")
            found |= dict.fromkeys(names, entry[2])
        elif found:
            found[names[-1]] += line
    return found


def raised(function: Any) -> set[str]:
    """Names of the exceptions that a function raises in its own body."""
    tree = ast.parse(textwrap.dedent(inspect.getsource(function)))
    calls = (node.exc for node in ast.walk(tree) if isinstance(node, ast.Raise) and node.exc is not None)
    names = (call.func if isinstance(call, ast.Call) else call for call in calls)
    return {name.id for name in names if isinstance(name, ast.Name) and name.id[0].isupper()}


by_name = pytest.mark.parametrize("of", EVERYTHING, ids=lambda of: of.name)


@by_name
def test_it_has_a_docstring_that_lists_what_it_takes(of: Described) -> None:
    assert of.text
    asked = [p.name for p in of.parameters]
    if not of.is_method or "Args:" in of.text:
        assert set(asked) <= listed(of.text, "Args").keys()
    elif len(asked) > 1:  # a short method may name them in its sentence
        assert [name for name in asked if not re.search(rf"(?<!\w){name}(?!\w)", of.text)] == []


@by_name
def test_a_function_says_what_it_returns(of: Described) -> None:
    if not of.is_method and of.parameters and of.returned not in ("None", "NoReturn"):
        assert "Returns:" in of.text


@by_name
def test_what_it_raises_is_said(of: Described) -> None:
    assert raised(of.function) <= set(re.findall(r"\w+Error", of.text))


@by_name
def test_numbers_come_with_shapes_units_and_frames(of: Described) -> None:
    entries = listed(of.text, "Args")
    for p in of.parameters:
        said = entries.get(p.name, of.text)
        if str(p.annotation) in ("float", "float | None"):
            assert UNIT.search(said), p.name
        if str(p.annotation).startswith(("Floats", "ArrayLike")):
            assert SHAPE.search(said), p.name
    if of.returned.startswith("Floats"):
        assert SHAPE.search(of.text)
    if of.returned == "float":
        assert UNIT.search(of.text)
    if "SE3" in of.returned:
        assert FRAME.search(of.text)


@pytest.mark.parametrize("name", CLASSES)
def test_a_class_has_a_docstring(name: str) -> None:
    assert inspect.getdoc(getattr(nk, name))


@pytest.mark.parametrize("name", RECORDS)
def test_every_field_is_described_with_shape_and_unit(name: str) -> None:
    entries = listed(inspect.getdoc(getattr(nk, name)) or "", "Attributes")
    for field in dataclasses.fields(getattr(nk, name)):
        if field.name.startswith("_"):
            continue
        said, kind = entries[field.name], str(field.type)
        if kind in ("float", "float | None", "Floats") and (name, field.name) not in WITHOUT_UNIT:
            assert UNIT.search(said), field.name
        if kind.startswith("Floats"):
            assert SHAPE.search(said), field.name


def test_a_users_program_passes_strict_type_checking(tmp_path: Path) -> None:
    program = ROOT / "tests" / "typing" / "users_program.py"
    command = [sys.executable, "-m", "mypy", "--strict", "--cache-dir", str(tmp_path), str(program)]
    environment = os.environ | {"MYPYPATH": str(ROOT / "src")}
    config = tmp_path / "mypy.ini"
    config.write_text(
        "[mypy]\n[mypy-pinocchio.*,coal.*,meshcat.*,trimesh.*,umsgpack.*]\nignore_missing_imports = True\n"
    )
    done = subprocess.run(
        [*command, "--config-file", str(config)],
        cwd=tmp_path,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout
