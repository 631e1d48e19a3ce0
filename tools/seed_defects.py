"""Single defects put into real robots: how many `nao-kin check` reports with the right code on the right line.

python tools/seed_defects.py                     300 defects; exit status 1 if fewer than 98 % are reported
python tools/seed_defects.py --defects 60 --seed 1

Each kind of defect gets its turn. An element is a fair place for one where it applies and where the file as it was
has no finding of that code on that line.
"""

from __future__ import annotations

import argparse
import sys
from collections import Counter
from dataclasses import dataclass, field
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from check_trials.defects import KINDS, TWIN_CODES, Kind, Seeded, seeded
from check_trials.mutants import pick
from check_trials.tags import Tag, tags_of
from fuzz_check import sources
from nao_kin.checks.checker import check_bytes

if TYPE_CHECKING:
    from pathlib import Path

    from nao_kin.checks.finding import Report

SHARE = 0.98
_TRIES = 400


@cache
def tags(path: Path) -> list[Tag]:
    """The elements of a file."""
    return tags_of(path.read_bytes())


@cache
def clean(path: Path) -> Report:
    """What is found in the file as it was."""
    return check_bytes(path.read_bytes(), str(path), folder=path.parent)


def place(kind: Kind, files: list[Path], rng: np.random.Generator) -> tuple[Path, Seeded] | None:
    """A random file and a random element that the defect applies to."""
    for _ in range(_TRIES):
        path = pick(files, rng)
        fit = [tag for tag in tags(path) if tag.path == kind.path]
        made = seeded(kind, pick(fit, rng), tags(path)) if fit else None
        if made is None:
            continue
        # Twins that differ already are no place to make one of them differ.
        spoilt = TWIN_CODES if kind.code in TWIN_CODES else {kind.code}
        if not any(finding.code in spoilt and finding.line in made.lines for finding in clean(path)):
            return path, made
    return None


@dataclass
class Outcome:
    """What all defects together have shown."""

    found: Counter[str] = field(default_factory=Counter)
    seeded: Counter[str] = field(default_factory=Counter)
    missed: list[str] = field(default_factory=list)

    def take(self, kind: Kind, path: Path, made: Seeded) -> None:
        """Checks one defective file and counts the verdict in."""
        report = check_bytes(made.text.encode("latin-1"), str(path), folder=path.parent)
        self.seeded[kind.code] += 1
        if any(finding.code == kind.code and finding.line in made.lines for finding in report):
            self.found[kind.code] += 1
            return
        new = [f"{f.line} {f.code}" for f in report if f.order[3:] not in {c.order[3:] for c in clean(path)}]
        self.missed.append(f"{kind.code} in {path.name} on {sorted(made.lines)}; new findings: {new[:4]}")


def main() -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--defects", type=int, default=300)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--robots", type=int, help="use so many of the files only")
    arguments = parser.parse_args()
    rng, outcome = np.random.default_rng(arguments.seed), Outcome()
    # A file that is refused as it is has no place for a single defect.
    chosen = sources()
    if arguments.robots is not None:
        chosen = [chosen[i] for i in sorted(rng.choice(len(chosen), arguments.robots, replace=False))]
    files = [path for path in chosen if not clean(path).errors]
    unplaced: Counter[str] = Counter()
    turn = 0
    while sum(outcome.seeded.values()) < arguments.defects and turn < 4 * arguments.defects:
        kind = KINDS[turn % len(KINDS)]
        turn += 1
        found = place(kind, files, rng)
        if found is None:
            unplaced[kind.code] += 1
        else:
            outcome.take(kind, *found)
    total, right = sum(outcome.seeded.values()), sum(outcome.found.values())
    print(f"files                         {len(files)}")
    print(f"kinds of defect               {len(KINDS)}, of {len({kind.code for kind in KINDS})} codes")
    print(f"defects                       {total}")
    print(f"reported, code and line right {right} = {100.0 * right / total:.1f} %")
    for line in outcome.missed:
        print(f"  missed: {line}")
    if unplaced:
        print(f"  no place found for: {dict(unplaced)}")
    return 0 if right >= SHARE * total else 1


if __name__ == "__main__":
    sys.exit(main())
