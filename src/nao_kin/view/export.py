"""Pages on their way out: into a file, or into a notebook."""

from __future__ import annotations

import html
import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from nao_kin.errors import InvalidInputError
from nao_kin.replacing import replace_file
from nao_kin.view.budget import DEFAULT_MAX_MB, fitted
from nao_kin.view.contents import scene_of
from nao_kin.view.page import page

if TYPE_CHECKING:
    import os
    from collections.abc import Callable

    from nao_kin.view.contents import Content, Subject
    from nao_kin.view.scene import Scene

__all__ = ["InlinePage", "export_html", "show"]


@dataclass(frozen=True, slots=True)
class InlinePage:
    """A page to be shown within another one: Jupyter displays it, and it stays in a notebook saved as HTML.

    Attributes:
        html: The page.
        title: What a screen reader calls the frame.
        height: Height of the frame in CSS pixels; its width is all there is.
    """

    html: str
    title: str
    height: int

    def __repr__(self) -> str:
        return f"InlinePage({self.title!r}, {len(self.html)} characters)"

    def _repr_html_(self) -> str:
        return (
            f'<iframe title="{html.escape(self.title)}" sandbox="allow-scripts" '
            f'style="width:100%;height:{self.height}px;border:0;border-radius:8px" '
            f'srcdoc="{html.escape(self.html)}"></iframe>'
        )


def export_html(
    path: str | os.PathLike[str],
    subject: Subject,
    content: Content | None = None,
    *,
    explain: bool = False,
    max_mb: float = DEFAULT_MAX_MB,
) -> Path:
    """Write a page of a robot, a chain, a result or a comparison: one file, no server, no network.

    The page is complete before the file is touched: a failure leaves what was there. The same input gives the same
    bytes.

    Args:
        path: Where to write; an existing file is replaced.
        subject: A `Robot`; or a chain, an `IKResult`, a `TreeResult`, what `solve_all` or `compare` returned.
        content: What a robot is shown with: a posture (joint name to angle [rad] or offset [m]; joints not named are
            at 0), named postures (name to posture, the first one solid and the others as ghosts), a `Trajectory`, a
            `Walk`, a `ReachMap`, or a result or solutions of one of its chains. None means `robot.neutral`.
        explain: Whether the page of a comparison says what accounts for the disagreement, which may have to be
            searched first.
        max_mb: Largest page [MB]; meshes are simplified to stay below it.

    Returns:
        The path written to.

    Raises:
        UnknownNameError: A posture or trajectory names a joint the robot does not have.
        InvalidInputError: Nothing that can be shown, a value that is not a finite number, no solutions, `path` is a
            directory or a device, or `max_mb` is too small for any picture.
        OSError: The file cannot be written.
    """
    return _written(path, lambda: scene_of(subject, content, explain=explain), max_mb)


def show(
    subject: Subject,
    content: Content | None = None,
    height: int = 480,
    *,
    explain: bool = False,
    max_mb: float = DEFAULT_MAX_MB,
) -> InlinePage:
    """The page of `export_html`, inline in a Jupyter notebook.

    Args:
        subject: As for `export_html`.
        content: As for `export_html`.
        height: Height of the frame in CSS pixels.
        explain: As for `export_html`.
        max_mb: As for `export_html` [MB].

    Returns:
        What Jupyter displays, also after the notebook was saved as HTML.

    Raises:
        UnknownNameError: A posture or trajectory names a joint the robot does not have.
        InvalidInputError: As `export_html`, or the height is not positive.
    """
    if not 0 < height < math.inf:
        raise InvalidInputError("height", "a positive number of CSS pixels", str(height))
    scene = scene_of(subject, content, explain=explain)
    return InlinePage(fitted(scene, max_mb, page), scene.title, int(height))


def _written(path: str | os.PathLike[str], scene: Callable[[], Scene], max_mb: float) -> Path:
    target = Path(path)
    if target.exists() and not target.is_file():
        kind = "directory" if target.is_dir() else "special file"
        raise InvalidInputError("path", "the name of a file to write", f"the {kind} {target}")
    return replace_file(target, fitted(scene(), max_mb, page).encode("utf-8"))
