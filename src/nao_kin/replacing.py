"""Files on their way out, replaced in one step: whoever had one there keeps it until the new one is complete."""

from __future__ import annotations

import contextlib
import os
import secrets
import stat
from pathlib import Path

__all__ = ["replace_file"]


def replace_file(path: str | os.PathLike[str], content: bytes) -> Path:
    """Puts a file's content in place in one step, through a neighbour in the same directory.

    A file that is replaced passes its permissions on. A device or a pipe is written to directly.

    Args:
        path: Where to; through a link, so that the link stays one.
        content: The whole content.

    Returns:
        The path written to.

    Raises:
        OSError: The file cannot be written; what was there is as it was.
    """
    target = Path(path)
    if target.exists() and not target.is_file():
        target.write_bytes(content)
        return target
    real = Path(os.path.realpath(target))
    neighbour = real.with_name(f".{real.name[:100]}.{secrets.token_hex(4)}.tmp")
    try:
        with neighbour.open("xb") as file:
            if real.exists():
                neighbour.chmod(stat.S_IMODE(real.stat().st_mode))
            file.write(content)
        neighbour.replace(real)
    except OSError as error:
        raise type(error)(error.errno, error.strerror, str(target)) from None  # the neighbour is nobody's business
    finally:
        with contextlib.suppress(OSError):
            neighbour.unlink(missing_ok=True)  # which it is already, unless something failed
    return target
