"""The ledger: every printed statement of the four documents, run and judged."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Final

from nao_kin.errors import UnknownNameError

if TYPE_CHECKING:
    from nao_kin.documents.claim import Claim

__all__ = ["claim", "claims"]

_MODULES: Final = (
    # 000, Bischoff 2016
    # 001, practicum
    "practicum_check_claims",
    "practicum_newton_claims",
    "practicum_inverse_claims",
    "practicum_profile_claims",
    "practicum_short_claims",
    # 002, hexapod article
    # 004, MATLAB example
    "matlab_matrix_claims",
    "matlab_solution_claims",
    "matlab_chain_claims",
)
"""Modules of this package with a tuple `CLAIMS` each, in the order of the documents."""


def claims() -> tuple[Claim, ...]:
    """Every claim, in the order of the documents; nothing is run."""
    modules = (importlib.import_module(f"nao_kin.documents.{name}") for name in _MODULES)
    return tuple(claim for module in modules for claim in module.CLAIMS)


def claim(name: str) -> Claim:
    """One claim by its name, for example ``"000:3.3.0.2"``.

    Raises:
        UnknownNameError: There is none of that name; carries near matches.
    """
    by_name = {claim.id: claim for claim in claims()}
    try:
        return by_name[name]
    except KeyError:
        raise UnknownNameError("claim", name, by_name) from None
