"""Write our own robots: data tables in, `urdf/*.urdf` out.

python tools/make_urdf.py                 writes the files
python tools/make_urdf.py --check         writes nothing; exit status 1 names the files that differ
python tools/make_urdf.py --output DIR    another folder than urdf/
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from urdf_tables import jaco2, nao, phantomx
from urdf_tables.writer import urdf_text

_FOLDER = Path(__file__).resolve().parent.parent / "urdf"


def texts() -> dict[str, str]:
    """File name to content, for every robot."""
    makers = (nao, jaco2, phantomx)
    return {f"{name}.urdf": urdf_text(maker.build(name)) for maker in makers for name in maker.NAMES}


def differing(folder: Path, wanted: dict[str, str]) -> list[str]:
    """The files that are missing, out of date or not ours to be there."""
    present = {path.name: path.read_bytes() for path in folder.glob("*.urdf")}
    names = present.keys() | wanted.keys()
    return sorted(name for name in names if present.get(name) != wanted.get(name, "").encode())


def main() -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description="Write the project's own URDF files from their data tables.")
    parser.add_argument("--check", action="store_true", help="write nothing; exit 1 naming the files that differ")
    parser.add_argument("--output", type=Path, default=_FOLDER, help="folder of the files (default: urdf/)")
    arguments = parser.parse_args()
    folder: Path = arguments.output
    wanted = texts()
    if arguments.check:
        stale = differing(folder, wanted)
        for name in stale:
            print(f"{name} differs from what tools/make_urdf.py writes", file=sys.stderr)
        return 1 if stale else 0
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in wanted.items():
        (folder / name).write_bytes(text.encode())
    return 0


if __name__ == "__main__":
    sys.exit(main())
