"""The pages of the documentation that are written by what they are about, in docs/reference/, whenever it is built.

python tools/docs_pages.py          write them; `make docs` does so by itself

They are not kept under version control: the codes of the check, the ledger and the public names say them anew.
"""

from __future__ import annotations

import ast
import importlib
import inspect
import pkgutil
import textwrap
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, get_args

import nao_kin as nk
from nao_kin.checks.catalogue import CATALOGUE
from nao_kin.documents.erratum import as_markdown
from nao_kin.robot.known import ALIASES, KNOWN_ROBOTS

if TYPE_CHECKING:
    from collections.abc import Iterator

    from nao_kin.checks.catalogue import Entry

DOCS: Final = Path(__file__).resolve().parent.parent / "docs"
FOLDER: Final = DOCS / "reference"

GROUPS: Final[tuple[tuple[str, str, tuple[str, ...]], ...]] = (
    (
        "api-robots",
        "API: robots, chains and tables",
        ("chain", "dh", "errors", "robot", "tolerances"),
    ),
    ("api-comparing", "API: comparing, and the ledger", ("crosscheck", "documents")),
    ("api-solving", "API: inverse kinematics", ("ik", "solving")),
    ("api-closed-forms", "API: closed forms", ("analytic",)),
    ("api-moving", "API: trajectories and workspaces", ("trajectory", "workspace")),
    ("api-calibrating", "API: calibration", ("calibration",)),
    ("api-checking", "API: checking URDF files", ("checks",)),
    ("api-pages", "API: pages", ("view",)),
)
"""Page, title and home modules of the public names; what lives elsewhere comes on a page of its own."""

MODULES: Final = (
    "analytic.hexapod.body",
    "analytic.nao.intervals",
    "analytic.nao.looking",
    "analytic.redundancy",
    "analytic.nao.symbolic_head",
    "crosscheck",
    "documents.claim",
    "errors",
    "ik.methods",
)
"""Modules whose public names are documented as well; those of `nao_kin.motion` and `nao_kin.trajectory` always are."""


def codes_page() -> str:
    """Every code of the check with its whole explanation."""
    lines = [
        "# Codes of `nao-kin check`",
        "",
        f"{len(CATALOGUE)} codes, by topic; `nao-kin explain CODE` prints the same.",
    ]
    for entry in CATALOGUE.values():
        lines += ["", *_explained(entry)]
    return _page(lines)


def _explained(entry: Entry) -> Iterator[str]:
    yield from (f"## {entry.code}", "", f"*{entry.severity}.* {_plain(entry.what)}", "", _plain(entry.why))
    for label, fragment in (("Wrong", entry.bad), ("Right", entry.good)):
        if fragment:
            yield from ("", f"{label}:", "", "```text", *fragment.split("\n"), "```")
    yield from ("", _plain(entry.fix))


def ledger_page() -> str:
    """The erratum sheet of the four documents, run now."""
    _, _, sheet = as_markdown(nk.ledger()).partition("\n")
    head = [
        "# Erratum sheet",
        "",
        "Every printed formula, table, number and algorithm of the four documents, run when this page was built.",
        "No verdict is written down: `nao-kin ledger` measures them again, `nao-kin ledger CLAIM` shows one whole.",
    ]
    return _page([*head, sheet])


def robots_page() -> str:
    """The robots that load by name."""
    lines = ["# Robots that load by name", "", "`nao-kin robots` prints them too, with the documents' chains.", ""]
    lines += ["| name | robot | chains | comes with |", "|---|---|---|---|"]
    for robot in KNOWN_ROBOTS.values():
        names = [robot.name, *(alias for alias, name in ALIASES.items() if name == robot.name)]
        extra = "nao_kin" if robot.source == "bundled" else "the extra `robots`"
        chains = ", ".join(f"`{chain}`" for chain in robot.chains)
        lines.append(f"| {', '.join(f'`{name}`' for name in names)} | {robot.title} | {chains} | {extra} |")
    return _page(lines)


def methods_page() -> str:
    """The table of methods, whole."""
    lines = [
        "# Methods of inverse kinematics",
        "",
        "What `nk.METHODS` holds; `nk.solve(..., method=NAME)` takes the name.",
    ]
    for method in nk.METHODS.values():
        lines += ["", f"## {method.name}", "", f"Choose it {method.choose_it}.", ""]
        lines += [f"* Source: {method.reference}.", f"* Targets: {', '.join(method.targets)}."]
        lines += ["* Several tips at once."] if method.several_tips else []
        lines += ["* Chains of hinges only."] if method.hinges else []
        for p in method.parameters:
            default = f"{p.factor:g}" + (f" · {p.per}" if p.per else "")
            lines.append(f"* `{p.name}` (default {default}): {p.meaning}.")
    return _page(lines)


def api_pages() -> dict[str, str]:
    """One page a group of public names, one of the types that they hand out, one a module beside them."""
    left = dict(sorted(nk._HOME.items(), key=lambda item: item[0].lower()))  # noqa: SLF001 (where names live)
    pages = {}
    for slug, title, homes in GROUPS:
        names = [name for name, home in left.items() if home.split(".")[0] in homes]
        pages[slug] = _reference(title, [_directive(name) for name in names])
        left = {name: home for name, home in left.items() if name not in names}
    if left:
        pages["api-more"] = _reference("API: more public names", [_directive(name) for name in left])
    pages["api-types"] = _reference("API: what public names hand out", [_class(name) for name in handed_out()])
    for module in documented_modules():
        pages[f"module-{module.replace('.', '-')}"] = _reference(f"nao_kin.{module}", [_module(module)])
    return pages


def documented_modules() -> tuple[str, ...]:
    """Modules that are documented beside the names of the package, without its name."""
    motion = pkgutil.walk_packages(importlib.import_module("nao_kin.motion").__path__, "nao_kin.motion.")
    beside = (module.name.removeprefix("nao_kin.") for module in motion if not module.ispkg)
    return (*MODULES, *beside, "trajectory")


def handed_out() -> tuple[str, ...]:
    """The classes that annotations of public names mention and that stand on no other page, and so on from those."""
    public = [getattr(nk, name) for name in nk.__all__]
    modules = [importlib.import_module(f"nao_kin.{name}") for name in documented_modules()]
    beside = [getattr(module, name) for module in modules for name in module.__all__]
    known, new = list[Any](), [*public, *beside]
    while new:
        known += new
        mentioned = {name: value for one in new for name, value in _mentioned(one).items()}
        new = [value for value in mentioned.values() if not any(value is other for other in known)]
    return tuple(
        sorted(f"{c.__module__}.{c.__qualname__}".removeprefix("nao_kin.") for c in known[len(public) + len(beside) :])
    )


def _mentioned(value: Any) -> dict[str, type]:
    """Our own public classes in the annotations of a class or function, by name; annotations are text here."""
    if not isinstance(value, type) and not inspect.isfunction(value):
        return {}
    (tree,) = ast.parse(textwrap.dedent(inspect.getsource(value))).body
    parts = tree.body if isinstance(tree, ast.ClassDef) else [tree]
    parts = [part for part in parts if not getattr(part, "name", "").startswith("_")]
    words = {
        node.id
        for owner in (node for part in parts for node in ast.walk(part))
        for field in ("annotation", "returns")
        if (written := getattr(owner, field, None)) is not None
        for node in ast.walk(written)
        if isinstance(node, ast.Name) and not node.id.startswith("_")
    }
    found = [_looked_up(value.__module__, word) for word in sorted(words)]
    things = [thing for one in found for thing in get_args(one) or (one,)]  # an alias may stand for several
    ours = [thing for thing in things if isinstance(thing, type) and thing.__module__.startswith("nao_kin")]
    return {thing.__qualname__: thing for thing in ours}


def _looked_up(module: str, word: str) -> Any:
    """What a word means in a module, imports for type checkers only included."""
    home = importlib.import_module(module)
    if hasattr(home, word):
        return getattr(home, word)
    for node in ast.walk(ast.parse(inspect.getsource(home))):
        if isinstance(node, ast.ImportFrom) and node.module and word in [alias.name for alias in node.names]:
            return getattr(importlib.import_module(node.module), word, None)
    return None


def _directive(name: str) -> str:
    """What documents a public name of the package."""
    value = getattr(nk, name)
    if isinstance(value, type):
        return _class(name)
    if callable(value):
        return f".. autofunction:: nao_kin.{name}"
    return f".. py:data:: nao_kin.{name}\n\n   See :doc:`{name.lower()}`."


def _class(name: str) -> str:
    return f".. autoclass:: nao_kin.{name}\n   :members:"


def _module(module: str) -> str:
    """What documents a module, without what has its place among the public names."""
    found = importlib.import_module(f"nao_kin.{module}")
    public = [getattr(nk, name) for name in nk.__all__]
    others = {f"nao_kin.{other}" for other in documented_modules()} - {f"nao_kin.{module}"}
    elsewhere = [
        name
        for name in found.__all__
        if any(getattr(found, name) is value for value in public)
        or getattr(getattr(found, name), "__module__", "") in others
    ]
    without = [f"   :exclude-members: {', '.join(elsewhere)}"] if elsewhere else []
    return "\n".join([f".. automodule:: nao_kin.{module}", "   :members:", *without])


def _reference(title: str, directives: list[str]) -> str:
    return _page([f"# {title}", "", "```{eval-rst}", "\n\n".join(directives), "```"])


def more() -> str:
    """A list of the pages that the first page does not name, for it to include."""
    first = (DOCS / "index.md").read_text(encoding="utf-8").split()
    names = [path.stem for path in sorted(DOCS.glob("*.md")) if path.stem not in ("index", *first)]
    return "\n".join(["```{toctree}", ":caption: More", ":maxdepth: 1", "", *names, "```", ""])


def _plain(text: str) -> str:
    """Text that markdown leaves as it is."""
    return text.replace("<", "\\<").replace("*", "\\*").replace("_", "\\_").replace("$", "\\$")


def _page(lines: list[str] | Iterator[str]) -> str:
    return "\n".join(lines).rstrip() + "\n"


def pages() -> dict[str, str]:
    """All of them by name, without the ending."""
    return {
        "codes": codes_page(),
        "errata": ledger_page(),
        "robots": robots_page(),
        "methods": methods_page(),
        **api_pages(),
    }


def write() -> None:
    """Writes them, and leaves alone what has not changed, so that a second build is a quick one."""
    FOLDER.mkdir(exist_ok=True)
    wanted = {FOLDER / f"{name}.md": text for name, text in pages().items()} | {FOLDER / "more.txt": more()}
    for path in set(FOLDER.glob("*.md")) - set(wanted):
        path.unlink()
    for path, text in wanted.items():
        if not path.is_file() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    write()
