"""What a project knows already, so that only new findings fail its CI."""

from __future__ import annotations

import hashlib
import json
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from nao_kin.checks.finding import Report
from nao_kin.errors import InvalidInputError

if TYPE_CHECKING:
    import os

    from nao_kin.checks.finding import Finding

__all__ = ["fingerprint", "read_baseline", "without_known", "write_baseline"]

_LAYOUT: Final = 1
_LARGEST: Final = 64 * 1024 * 1024  # [bytes]


def fingerprint(finding: Finding) -> str:
    """What stays of a finding when lines are moved about: its file, code and element, hashed."""
    text = "\0".join((finding.path.replace("\\", "/"), finding.code, finding.element))
    return hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()[:32]


def write_baseline(report: Report, path: str | os.PathLike[str]) -> None:
    """Record the findings of a report.

    Raises:
        OSError: The file cannot be written.
    """
    counts = Counter(fingerprint(finding) for finding in report)
    known = [
        {"fingerprint": key, "count": counts[key], "path": f.path, "code": f.code, "element": f.element}
        for key, f in {fingerprint(finding): finding for finding in report}.items()
    ]
    text = json.dumps({"layout": _LAYOUT, "known": known}, indent=1, ensure_ascii=False)
    Path(path).write_text(text + "\n", encoding="utf-8", errors="replace")


def read_baseline(path: str | os.PathLike[str]) -> Counter[str]:
    """How often each finding is known, by fingerprint.

    Raises:
        InvalidInputError: The file is no baseline.
        OSError: It cannot be read.
    """
    try:
        with Path(path).open("rb") as file:
            data: Any = json.loads(file.read(_LARGEST))
        if data["layout"] != _LAYOUT:
            raise InvalidInputError(f"baseline {path}", f"layout {_LAYOUT}", f"layout {data['layout']!r}")
        return Counter({str(row["fingerprint"]): int(row["count"]) for row in data["known"]})
    except (ValueError, TypeError, KeyError, RecursionError, OverflowError) as error:
        if isinstance(error, InvalidInputError):
            raise
        raise InvalidInputError(f"baseline {path}", "a file written with --update-baseline", "another one") from None


def without_known(report: Report, known: Counter[str]) -> Report:
    """The findings that a baseline does not know; of several alike in one element, the last ones are new."""
    left = known.copy()
    new = []
    for finding in report:
        key = fingerprint(finding)
        if left[key] > 0:
            left[key] -= 1
        else:
            new.append(finding)
    return Report.of(report.paths, new, report.incomplete)
