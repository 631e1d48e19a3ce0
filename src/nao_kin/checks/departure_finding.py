"""A comparison's verdict as a finding of the file; the comparison itself is made elsewhere, and never imported here."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING

from nao_kin.checks.checker import finding_of
from nao_kin.checks.subject import Subject
from nao_kin.urdf.document import read_bytes
from nao_kin.urdf.outline import Defect, Outline
from nao_kin.urdf.positions import Positions
from nao_kin.urdf.safe_xml import read_tree

if TYPE_CHECKING:
    from nao_kin.checks.finding import Finding

__all__ = ["departure_finding"]


def departure_finding(
    path: str | os.PathLike[str], code: str, joint: str | None, message: str, hint: str = ""
) -> Finding:
    """A finding at a joint of a file, or at its root where no joint is named or the file has none of that name.

    Args:
        path: The file that departs.
        code: ``"departs-from-table"`` or ``"departs-from-model"``.
        joint: Where it departs.
        message: How, one sentence.
        hint: What would make the two agree.

    Raises:
        UrdfError: The file cannot be read.
    """
    name = os.fspath(path)
    data = read_bytes(name)
    root = read_tree(data, name)
    outline = Outline(root)
    at = outline.joint_by_name.get(joint or "", root)
    subject = Subject(name, data, outline, Positions.of(data, root), Path(name).absolute().parent)
    return finding_of(subject, Defect(code, at, message, hint, "name"))
