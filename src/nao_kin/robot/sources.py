"""What a name or a path stands for: the file behind it, read, and what is known about the robot beyond it."""

from __future__ import annotations

import os
import warnings
from typing import TYPE_CHECKING

from nao_kin.errors import UnknownNameError, UrdfWarning
from nao_kin.robot.known import find_known, robot_file
from nao_kin.urdf import read_urdf

if TYPE_CHECKING:
    from nao_kin.robot.known import KnownRobot
    from nao_kin.urdf import UrdfDocument

__all__ = ["read_source", "tell"]


def read_source(robot: str | os.PathLike[str]) -> tuple[UrdfDocument, KnownRobot | None]:
    """The content of the file that is meant, and the known robot that it belongs to, if it is one.

    Raises:
        UnknownNameError, MissingExtraError, UrdfError: See `nao_kin.load`.
    """
    if isinstance(robot, str) and not robot.endswith(".urdf") and os.sep not in robot:
        try:
            known = find_known(robot)
        except UnknownNameError:
            if os.path.isfile(robot):  # noqa: PTH113 - false, where Path would raise, for a name too long
                return read_urdf(robot), None
            raise
        return read_urdf(robot_file(known)), known
    return read_urdf(robot), None


def tell(document: UrdfDocument, stacklevel: int = 2) -> None:
    """Warn, once for a file, about what it was read in spite of."""
    if document.tolerated:
        told = "; ".join(text.rstrip(".") for text in document.tolerated)
        said = f"{document.path} was read, but {told}. `nao-kin check` says what to do."
        warnings.warn(said, UrdfWarning, stacklevel=stacklevel + 1)
