"""Every code with its severity and its explanation: what, why it matters, wrong and right, how to fix it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from nao_kin.checks.catalogue.control_codes import CONTROL
from nao_kin.checks.catalogue.entry import Entry
from nao_kin.checks.catalogue.file_codes import FILES
from nao_kin.checks.catalogue.joint_codes import JOINTS
from nao_kin.checks.catalogue.link_codes import LINKS
from nao_kin.checks.catalogue.model_codes import MODELS
from nao_kin.checks.catalogue.name_codes import NAMES
from nao_kin.errors import UnknownNameError

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["CATALOGUE", "Entry", "require_codes"]

CATALOGUE: Final[dict[str, Entry]] = {
    entry.code: entry for entry in (*FILES, *NAMES, *JOINTS, *LINKS, *CONTROL, *MODELS)
}
"""Entries by code, by topic in the order in which a reader would ask."""


def require_codes(codes: Iterable[str]) -> None:
    """Make sure that every code is one of the catalogue.

    Raises:
        UnknownNameError: One is not; carries near matches.
    """
    for code in codes:
        if code not in CATALOGUE:
            raise UnknownNameError("code", code, CATALOGUE)
