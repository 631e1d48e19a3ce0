"""The npz file of a workspace map: written whole, read without trust."""

from __future__ import annotations

import errno
import io
import lzma
import math
import tokenize
import zipfile
import zlib
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, Final

import numpy as np

from nao_kin.errors import InvalidInputError
from nao_kin.replacing import replace_file

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping

    from numpy.typing import NDArray

__all__ = ["MOST_CELLS", "MOST_SAMPLES", "read_map", "write_map"]

MOST_CELLS: Final = 2**23
"""Most cubes of a map; at 24 bytes each, 200 MB."""

MOST_SAMPLES: Final = 2**31 - 1
"""Most configurations of a map: a sum of so many measures, each below 2³², fits 63 bits."""

_FORMAT: Final = 1
_TEXTS: Final = ("chain", "base_name", "tip_name", "measure", "axes", "unit", "sampling")
_FREE_TEXTS: Final = ("chain", "base_name", "tip_name", "unit")
_NUMBERS: Final = {"format": "i", "voxel": "f", "seed": "iu"}  # the kinds of their types
_GRIDS: Final = {"counts": "i", "greatest": "f", "mean": "f"}
_NAMES: Final = {*_TEXTS, *_NUMBERS, *_GRIDS, "corner"}
_MOST_CHARACTERS: Final = 1000
_LARGEST_VOXEL: Final = 1e6  # [m]
_UNREADABLE: Final = (  # what zipfile, the decompressors and numpy's reader of headers raise
    zipfile.BadZipFile,
    zlib.error,
    lzma.LZMAError,
    tokenize.TokenError,
    EOFError,
    MemoryError,
    NotImplementedError,
    RuntimeError,
    SystemError,
    ValueError,
)
_OF_CONTENT: Final = (None, errno.EINVAL)  # bz2 on damaged data, and a place before the file's beginning
_CHOICES: Final = {
    "measure": ("none", "manipulability", "smallest_singular_value"),
    "sampling": ("random", "even"),
}


def write_map(path: str | os.PathLike[str], fields: Mapping[str, Any]) -> Path:
    """Writes the fields of a map; the file appears with its whole content or, if there is no room, not at all."""
    content = io.BytesIO()
    np.savez_compressed(content, format=np.int64(_FORMAT), **fields)
    return replace_file(path, content.getvalue())


def read_map(path: str | os.PathLike[str]) -> dict[str, Any]:
    """The fields of a map, checked.

    Raises:
        InvalidInputError: The file is no map, too large, or contradicts itself.
    """
    name = Path(path).name
    try:
        with zipfile.ZipFile(path) as archive:
            fields = _read(archive, name)
    except (*_UNREADABLE, OSError) as error:
        if isinstance(error, InvalidInputError) or (isinstance(error, OSError) and error.errno not in _OF_CONTENT):
            raise
        raise InvalidInputError(name, "a map that ReachMap.save wrote", f"{type(error).__name__}: {error}") from None
    _check_content(fields, name)
    del fields["format"]
    return fields


def _read(archive: zipfile.ZipFile, name: str) -> dict[str, Any]:
    entries = [entry.filename for entry in archive.infolist()]
    if sorted(entries) != sorted(f"{field}.npy" for field in _NAMES):
        raise InvalidInputError(name, f"the arrays {', '.join(sorted(_NAMES))}", ", ".join(entries[:20]) or "none")
    fields: dict[str, Any] = {}
    for field in _NAMES:
        with archive.open(f"{field}.npy") as entry:
            _check_header(entry, field, name)
        with archive.open(f"{field}.npy") as entry:
            array = np.lib.format.read_array(entry, allow_pickle=False)
        fields[field] = array.item() if field in _TEXTS or field in _NUMBERS else np.ascontiguousarray(array)
    return fields


def _check_header(entry: IO[bytes], field: str, name: str) -> None:
    """Refuses what is not of the kind and size it has to be, before memory is asked for."""
    version = np.lib.format.read_magic(entry)
    if version != (1, 0):
        raise InvalidInputError(f"{field} in {name}", "npy format 1.0", f"{version}")
    shape, _, dtype = np.lib.format.read_array_header_1_0(entry)
    if field in _GRIDS:
        good = dtype.kind in _GRIDS[field] and len(shape) == 3 and 0 < math.prod(shape) <= MOST_CELLS
        expected = f"numbers (nx, ny, nz), {MOST_CELLS} at most"
    elif field == "corner":
        good, expected = dtype.kind == "i" and shape == (3,), "3 whole numbers"
    else:
        kinds = "U" if field in _TEXTS else _NUMBERS[field]
        good = dtype.kind in kinds and shape == () and dtype.itemsize <= 4 * _MOST_CHARACTERS
        expected = "a short text" if field in _TEXTS else "a number"
    if not good:
        raise InvalidInputError(f"{field} in {name}", expected, f"{dtype} of shape {shape}")


def _check_content(fields: dict[str, Any], name: str) -> None:
    counts, corner = fields["counts"], fields["corner"]
    ends_reached = all(counts.any(axis=tuple({0, 1, 2} - {a}))[[0, -1]].all() for a in range(3))
    grids = [fields[grid] for grid in _GRIDS]
    checks = {
        "format": (fields["format"] == _FORMAT, f"version {_FORMAT}"),
        "voxel": (0.0 < fields["voxel"] <= _LARGEST_VOXEL, f"a number > 0, at most {_LARGEST_VOXEL:g} m"),
        "seed": (fields["seed"] >= 0, "a whole number ≥ 0"),
        "axes": (fields["axes"] in ("x", "y", "z", "xy", "xz", "yz", "xyz"), "some of x, y, z"),
        **{field: (fields[field] in choices, " or ".join(choices)) for field, choices in _CHOICES.items()},
        "corner": (int(np.abs(corner.astype(np.float64)).max()) < 2**31, "cubes not farther than 2³¹ from the base"),
        **{field: (_is_unicode(fields[field]), "text that is Unicode") for field in _FREE_TEXTS},
        "counts": (
            _are_counts(counts) and ends_reached,
            f"counts ≥ 0, at most {MOST_SAMPLES} in all, some on every side",
        ),
        "greatest": (all(grid.shape == counts.shape for grid in grids), f"shape {counts.shape}, as counts"),
        "mean": (all(bool((np.isfinite(g) & (g >= 0)).all()) for g in grids), "finite numbers ≥ 0"),
    }
    for field, (good, expected) in checks.items():
        if not good:
            value = fields[field]
            got = f"an array {value.shape}" if isinstance(value, np.ndarray) else repr(value)
            raise InvalidInputError(f"{field} in {name}", expected, got)


def _is_unicode(text: str) -> bool:
    """Whether it can be written down: half a surrogate pair cannot."""
    return not any("\ud800" <= character <= "\udfff" for character in text)


def _are_counts(counts: NDArray[np.int64]) -> bool:
    """Whether they are counts whose sum a map can have; summed as floats, which do not run over."""
    return bool((counts >= 0).all()) and float(counts.sum(dtype=np.float64)) <= MOST_SAMPLES
