"""Every code with its severity and its explanation: what, why it matters, wrong and right, how to fix it."""

from __future__ import annotations

from typing import Final

from nao_kin.checks.catalogue.entry import Entry
from nao_kin.checks.catalogue.files import FILES
from nao_kin.checks.catalogue.joints import JOINTS
from nao_kin.checks.catalogue.links import LINKS
from nao_kin.checks.catalogue.models import MODELS
from nao_kin.checks.catalogue.names import NAMES

__all__ = ["CATALOGUE", "Entry"]

CATALOGUE: Final[dict[str, Entry]] = {entry.code: entry for entry in (*FILES, *NAMES, *JOINTS, *LINKS, *MODELS)}
"""Entries by code, by topic in the order in which a reader would ask."""
