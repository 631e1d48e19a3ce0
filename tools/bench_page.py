"""Runs `nao-kin bench`, keeps its reports in docs/bench/, and writes every measured table of README and docs from them.

python tools/bench_page.py                write the page and the tables from what is kept
python tools/bench_page.py --run          measure everything again first; some minutes, on a machine that is quiet
python tools/bench_page.py --run ik fk    measure these again first

A measured table stands between two comments, which name the run, the sheet and the columns to show:

    <!-- measured: ik single_pose solver success median_ratio -->
    <!-- /measured -->

What stands between them belongs to this program. Columns are keys of the sheet; without any, all are shown.
"""

from __future__ import annotations

import argparse
import importlib.metadata
import json
import re
import subprocess
import sys
from pathlib import Path
from typing import Any, Final

from nao_kin.bench.peers import PEERS
from nao_kin.bench.sheet import Heading, Machine, Promise

ROOT: Final = Path(__file__).resolve().parent.parent
KEPT: Final = ROOT / "docs" / "bench"
PAGE: Final = ROOT / "docs" / "benchmarks.md"

RUNS: Final[dict[str, tuple[str, ...]]] = {
    "fk": (),
    "ik": ("--peers",),
    "edges": ("--peers",),
    "methods": (),
    "closed": (),
    "sixr": ("--peers",),
    "tips": (),
    "reach": (),
    "practicum": (),
    "trajectory": (),
    "gait": (),
    "guard": (),
    "servo": (),
    "loop": (),
    "page": (),
    "explain": (),
    "mutants": (),
    "startup": (),
}
"""Arguments of each benchmark that the page shows, in its order."""

_ABOUT: Final = (
    "Written by `python tools/bench_page.py --run`. Each section is one run of the command it names, peers included,",
    "so compare figures within a section only. An answer, a peer's too, counts as solved only where Pinocchio confirms",
    "it. A missed goal stays on the page.",
)
_MARKED: Final = re.compile(r"(<!-- measured: ([^>]+?) -->\n).*?(<!-- /measured -->)", flags=re.DOTALL)
_TARGETS: Final = ("README.md", "docs/*.md")


def command(name: str) -> str:
    """What prints the figures of a run."""
    return " ".join(("nao-kin", "bench", name, *RUNS[name]))


def measure(name: str) -> None:
    """Runs one benchmark, peers beside where there are any, and keeps its report with the peers' versions."""
    words = [sys.executable, "-m", "nao_kin", "bench", name, *RUNS[name], "--no-goals", "--format", "json"]
    done = subprocess.run(words, stdout=subprocess.PIPE, text=True, check=True)
    report = json.loads(done.stdout)
    if "--peers" in RUNS[name]:
        report["machine"]["versions"] |= _peer_versions()
    KEPT.mkdir(exist_ok=True)
    text = json.dumps(report, indent=1, ensure_ascii=False)
    (KEPT / f"{name}.json").write_text(text + "\n", encoding="utf-8")


def kept() -> dict[str, dict[str, Any]]:
    """The reports that are kept, by the name of the benchmark, in the order of the page."""
    paths = {name: KEPT / f"{name}.json" for name in RUNS}
    return {name: json.loads(path.read_text(encoding="utf-8")) for name, path in paths.items() if path.is_file()}


def sheet_table(report: dict[str, Any], sheet: str, keys: tuple[str, ...] = ()) -> str:
    """A sheet of a report as a markdown table.

    Args:
        report: What a benchmark printed.
        sheet: The sheet's name.
        keys: The columns to show, in this order; all if empty.
    """
    (found,) = (each for each in report["sheets"] if each["name"] == sheet)
    by_key = {column["key"]: Heading(**column) for column in found["columns"]}
    headings = [by_key[key] for key in keys or by_key]
    rows = [[heading.cell(row) for heading in headings] for row in report[sheet]]
    return table([heading.text for heading in headings], rows, [bool(heading.spec) for heading in headings])


def table(headings: list[str], rows: list[list[str]], numbers: list[bool]) -> str:
    """A markdown table."""
    lines = [headings, ["---:" if number else "---" for number in numbers], *rows]
    return "\n".join(f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in line)} |" for line in lines)


def with_measured_tables(text: str, reports: dict[str, dict[str, Any]]) -> str:
    """The text of a page with its measured tables written anew."""

    def fill(match: re.Match[str]) -> str:
        name, sheet, *keys = match[2].split()
        return f"{match[1]}\n{sheet_table(reports[name], sheet, tuple(keys))}\n\n{match[3]}"

    return _MARKED.sub(fill, text)


def page(reports: dict[str, dict[str, Any]]) -> str:
    """The page of all benchmarks."""
    lines = ["# Benchmarks", "", *_ABOUT]
    for name, report in reports.items():
        lines += ["", f"## bench {name}", "", "```sh", command(name), "```", "", *_machine(report["machine"])]
        for sheet in report["sheets"]:
            lines += ["", f"### {name}: {sheet['title']}", "", sheet_table(report, sheet["name"])]
        lines += ["", f"### {name}: goals", "", _goals(report["goals"]), ""]
        lines += [f"* {note}" for note in report["notes"] if note]
    return "\n".join(lines).rstrip() + "\n"


def _machine(machine: dict[str, Any]) -> list[str]:
    return [str(Machine(**machine))]


def _goals(goals: list[dict[str, Any]]) -> str:
    found = [Promise(goal["what"], _number(goal["value"]), _number(goal["bound"]), goal["at_least"]) for goal in goals]
    rows = [[g.what, f"{g.value:.4g}", f"{'≥' if g.at_least else '≤'} {g.bound:.4g}", _yes(g.met)] for g in found]
    return table(["goal", "is", "should be", "met"], rows, [False, True, True, False])


def _number(value: float | None) -> float:
    return float("nan") if value is None else value


def _yes(met: bool) -> str:
    return "yes" if met else "**no**"


def _peer_versions() -> dict[str, str]:
    """Versions of the peers that are installed, by the name of the package."""
    found = {}
    for package in (peer.package.split()[0].strip("'") for peer in PEERS.values()):
        try:
            found[package] = importlib.metadata.version(package)
        except importlib.metadata.PackageNotFoundError:
            continue
    return found


def written() -> dict[Path, str]:
    """Every page that shows something measured, with the text that it should have."""
    reports = kept()
    pages = {PAGE: page(reports)}
    for pattern in _TARGETS:
        for path in sorted(ROOT.glob(pattern)):
            text = path.read_text(encoding="utf-8")
            if path != PAGE and _MARKED.search(text):
                pages[path] = with_measured_tables(text, reports)
    return pages


def main() -> int:
    """Measures what was asked for and writes the pages."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--run", nargs="*", choices=RUNS, metavar="NAME", help="benchmarks to run; all without a name")
    asked = parser.parse_args().run
    for name in RUNS if asked == [] else asked or ():
        print(command(name), flush=True)
        measure(name)
    for path, text in written().items():
        path.write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
