"""Six turning joints recognised by their axes, in any frame and with any joint zeros: what is parallel, what meets.

Four classes have a closed form; each is also recognised from its tip, that is with its joints in the opposite order.

* Three parallel axes, as Universal Robots': axes 2, 3 and 4 parallel, 5 and 6 meet.
* Spherical wrist, as most industrial arms': axes 2 and 3 parallel, 4, 5 and 6 meet in one point.
* Bent wrist, as Kinova's JACO2: axes 2 and 3 parallel, 4 and 5 meet, 5 and 6 meet. One equation in one joint.
* Any other arm is for the general elimination in `nao_kin.analytic.six_r.general`.

A file's numbers are rounded, so an arm need not be exact: up to `PARALLEL` and `MEETING` the class nearest to it is
solved, and each solution is then moved on to the arm's own numbers and certified on them.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.analytic.form import Geometry, Mismatch, Screws, screws
from nao_kin.analytic.ranges import middles_and_halves
from nao_kin.analytic.six_r import shared as layout
from nao_kin.kernels.motion import packed_joints

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.kernels.joint_path import JointPath

__all__ = ["LABELS", "MEETING", "PARALLEL", "SINGULARITIES", "SixRClass", "classify", "recognise"]

PARALLEL: Final = 1e-5
"""Up to this angle [rad] between them two axes count as parallel."""

MEETING: Final = 1e-4
"""Up to this distance [m] axes count as meeting, relative to arms of a metre."""

_CROSSING: Final = 1e-3  # [rad]: axes nearer to parallel than this do not meet anywhere in particular
_SHORTEST: Final = 1e-4  # a link below this [m] is none

LABELS: Final = tuple(
    f"shoulder {shoulder}, elbow {elbow}, wrist {wrist}" for shoulder in "+−" for wrist in "+−" for elbow in "+−"
)
"""Shoulder, elbow and wrist: which of the two values of that joint, above or below the middle between them.

For an arm that is solved from its tip the first axes are its last ones.
"""

_FREE: Final = (
    "both shoulder branches in one",
    "any first joint",
    "any turn of the aligned wrist axes",
    "both elbow branches in one",
    "any second joint",
    "both wrist branches in one",
)
SINGULARITIES: Final = tuple(
    ", ".join(words for bit, words in enumerate(_FREE) if number >> bit & 1) for number in range(1 << len(_FREE))
)
"""What is free at a singularity, by the sum of the kernel's bits."""


@dataclass(frozen=True, slots=True)
class SixRClass:
    """What makes a class, joints counted from 0 from its own base.

    Attributes:
        name: Its name.
        parallel: The joints whose axes are parallel.
        meeting: Groups of joints whose axes meet in one point.
    """

    name: str
    parallel: tuple[int, ...]
    meeting: tuple[tuple[int, ...], ...]


THREE_PARALLEL: Final = SixRClass("six_r_parallel", (1, 2, 3), ((4, 5),))
SPHERICAL: Final = SixRClass("six_r_spherical", (1, 2), ((3, 4, 5),))
BENT_WRIST: Final = SixRClass("six_r_bent_wrist", (1, 2), ((3, 4), (4, 5)))
CLASSES: Final = (SPHERICAL, THREE_PARALLEL, BENT_WRIST)


def classify(path: JointPath) -> str:
    """What was measured of a flat chain against each class, one line each, for people."""
    lines = []
    for kind in CLASSES:
        found = recognise(path, kind)
        if isinstance(found, Mismatch):
            lines.append(f"{kind.name}: no; {found.reason}")
            continue
        side = "its tip" if found.parameters[layout.BACKWARDS] else "its base"
        lines.append(f"{kind.name}: yes, seen from {side}; departs by at most {found.residual:.3g} [m, rad]")
    return "\n".join(lines)


def recognise(path: JointPath, kind: SixRClass) -> Geometry | Mismatch:
    """The arm's numbers for the kernels, of a path that is of a class, or its mirror; else what departs."""
    arm = screws(path, 6)
    if isinstance(arm, Mismatch):
        return arm
    forwards = _measured(arm, path, kind, backwards=False)
    if isinstance(forwards, Geometry):
        return forwards
    mirrored = Screws(-arm.axes[::-1], arm.points[::-1], arm.tip)
    backwards = _measured(mirrored, path, kind, backwards=True)
    if isinstance(backwards, Geometry):
        return backwards
    return Mismatch(f"{forwards.reason}; from its tip, {backwards.reason}")


def _measured(arm: Screws, path: JointPath, kind: SixRClass, *, backwards: bool) -> Geometry | Mismatch:
    axes, points = arm.axes.copy(), arm.points.copy()
    numbers = [6 - k if backwards else k + 1 for k in range(6)]
    first = kind.parallel[0]
    signs = [1.0 if axes[k] @ axes[first] > 0.0 else -1.0 for k in kind.parallel]
    tilted = {k: _tilt(axes[first], axes[k]) for k in kind.parallel[1:]}
    for k, tilt in tilted.items():
        if tilt > PARALLEL:
            return Mismatch(
                f"axes {numbers[first]} and {numbers[k]} are {tilt:.3g} rad off parallel where {PARALLEL:g} is allowed"
            )
    residual, meet = max(tilted.values()), {}
    for group in kind.meeting:
        together = " and ".join(map(str, sorted(numbers[k] for k in group)))
        if min(_tilt(axes[a], axes[b]) for a, b in itertools.pairwise(group)) < _CROSSING:
            return Mismatch(f"axes {together} are parallel and meet nowhere")
        meet[group], apart = _meeting_point(axes[list(group)], points[list(group)])
        if apart > MEETING:
            return Mismatch(f"axes {together} miss a common point by {apart:.3g} m where {MEETING:g} is allowed")
        residual = max(residual, apart)
    if _tilt(axes[0], axes[first]) < _CROSSING:
        return Mismatch(f"axes {numbers[0]} and {numbers[first]} are parallel")
    h = np.mean([sign * axes[k] for k, sign in zip(kind.parallel, signs, strict=True)], axis=0)
    h /= np.linalg.norm(h)
    # Joints turn about the common normal in its own sense; the kernels' senses are put right by `_packed`.
    for k, sign in zip(kind.parallel, signs, strict=True):
        axes[k] = sign * h
    for group, place in meet.items():
        points[group[-1]] = place
        if len(meet) > 1 or len(group) == 3:
            points[list(group[:-1])] = place
    if kind is BENT_WRIST:
        lever = points[5] - points[3]
        length = float(np.linalg.norm(lever))
        if length < _SHORTEST:
            return Mismatch(f"its bent wrist is {length:.3g} m long, too short to be one")
        axes[4] = lever / length * np.sign(lever @ axes[4])
    return _packed(arm, Screws(axes, points, arm.tip), path, kind, np.array(signs), residual, backwards=backwards)


def _packed(
    own: Screws,
    exact: Screws,
    path: JointPath,
    kind: SixRClass,
    signs: Floats,
    residual: float,
    *,
    backwards: bool,
) -> Geometry | Mismatch:
    axes, points, tip = exact.axes.copy(), exact.points, own.tip
    sense = np.ones(6)
    sense[list(kind.parallel)] = signs
    axes *= sense[:, None]
    own_axes = own.axes * sense[:, None]
    h = axes[1]
    across = np.cross(h, np.eye(3)[int(np.abs(h).argmin())])
    across /= np.linalg.norm(across)
    plane = np.stack([across, np.cross(h, across)])
    wrist = points[3] if kind is BENT_WRIST else points[5]
    ends = [points[1], points[2], points[3] if kind is THREE_PARALLEL else wrist, wrist]
    links = [plane @ (b - a) for a, b in itertools.pairwise(ends)]
    lengths = [float(np.linalg.norm(link)) for link in links]
    if min(lengths[:2]) < _SHORTEST:
        return Mismatch(f"its two links are {lengths[0]:.3g} m and {lengths[1]:.3g} m long, too short to be any")
    numbers = np.empty(layout.SIZE)
    numbers[layout.BACKWARDS] = float(backwards)
    numbers[layout.TIP : layout.AXES] = *tip[:3, :3].ravel(), *(tip[:3, 3])
    numbers[layout.AXES : layout.POINTS], numbers[layout.POINTS : layout.OWN_AXES] = axes.ravel(), points.ravel()
    numbers[layout.OWN_AXES : layout.OWN_POINTS] = own_axes.ravel()
    numbers[layout.OWN_POINTS : layout.ACROSS] = own.points.ravel()
    numbers[layout.ACROSS : layout.MIDDLES] = plane.ravel()
    middles, _ = middles_and_halves(path.lower, path.upper)
    numbers[layout.MIDDLES : layout.UPPER] = sense * (middles[::-1] if backwards else middles)
    for start, link, length in zip((layout.UPPER, layout.LOWER, layout.LAST), links, lengths, strict=True):
        numbers[start], numbers[start + 1] = length, np.arctan2(link[1], link[0])
    numbers[layout.SIDE] = h @ (wrist - points[0])
    numbers[layout.RESIDUAL] = residual
    numbers[layout.SCALE] = max(sum(lengths), float(np.abs(points - points[0]).max()))
    numbers[layout.SENSES : layout.FOREARM] = sense
    numbers[layout.JOINTS : layout.SIZE] = packed_joints(path).ravel()
    numbers[layout.FOREARM : layout.JOINTS] = _forearm(axes, plane @ axes[3], links[1])
    return Geometry(numbers, residual)


def _forearm(axes: Floats, plane4: Floats, link: Floats) -> tuple[float, float, float, float]:
    """Axis 4 for the bent wrist: in the plane as seen along the lower link (2,), across it, and its angle to axis 5."""
    square = float(link @ link)
    along = float(plane4 @ link) / square
    beside = float(link[0] * plane4[1] - link[1] * plane4[0]) / square
    return along, beside, float(axes[3] @ axes[1]), float(axes[3] @ axes[4])


def _tilt(a: Floats, b: Floats) -> float:
    """Angle between two lines' directions [rad]."""
    return float(np.arctan2(np.linalg.norm(np.cross(a, b)), abs(a @ b)))


def _meeting_point(axes: Floats, points: Floats) -> tuple[Floats, float]:
    """The point nearest to some lines (3,), and how far it is from the farthest of them [m]."""
    across = np.eye(3) - np.einsum("ki,kj->kij", axes, axes)
    place, *_ = np.linalg.lstsq(across.sum(axis=0), np.einsum("kij,kj->i", across, points), rcond=None)
    missed = np.einsum("kij,kj->ki", across, place - points)
    return place, float(np.linalg.norm(missed, axis=1).max())
