"""Hand-written Denavit-Hartenberg tables: chains of rows, and the ways from and to files, URDF and other chains."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nao_kin.lazy import lazily

if TYPE_CHECKING:
    from nao_kin.dh.dh_chain import DHChain as DHChain
    from nao_kin.dh.dh_row import DHRow as DHRow
    from nao_kin.dh.from_chain import to_dh as to_dh

__all__ = ["DHChain", "DHRow", "to_dh"]

__getattr__ = lazily(
    __name__,
    {"DHChain": "dh_chain", "DHRow": "dh_row", "to_dh": "from_chain"},
)
