"""For which elbow yaws a NAO's hand can be somewhere: the free parameter's intervals within the limits, by branch.

Where a branch enters or leaves the limits, or begins or ends to exist, a joint is at a limit or two branches meet.
Every such elbow yaw is a root of equations that are linear in a cosine and a sine, or quadratic, so all of them are
found; in between, one look at the middle decides.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from nao_kin.analytic.certifying import placed
from nao_kin.analytic.form import GOALS
from nao_kin.analytic.matching import Matched, matched
from nao_kin.analytic.nao.nao_arm import BASE, LENGTH, OFFSET, SHIFTS, SHOULDER, TIP
from nao_kin.chain import outside_limits
from nao_kin.errors import InvalidInputError
from nao_kin.ik.target import Target, TargetLike
from nao_kin.kernels.trigonometry import circle_roots

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain

__all__ = ["Interval", "elbow_yaw_intervals"]

_SAME: Final = 1e-12  # critical values nearer than this are one [rad]
_ELBOW_YAW: Final = 2  # column among the arm's joints
_PITCH, _ROLL, _ELBOW_ROLL = 0, 1, 3


@dataclass(frozen=True, slots=True)
class Interval:
    """Values of the free joint over which one branch stays within limits.

    Attributes:
        lower: Least value [rad].
        upper: Greatest value [rad].
        branch: The branch in words.
    """

    lower: float
    upper: float
    branch: str


def elbow_yaw_intervals(
    chain: Chain, target: TargetLike, *, locked: Mapping[str, float] | None = None
) -> tuple[Interval, ...]:
    """The elbow yaws, within their own limits, for which an arm's tip can be at a position with all joints in limits.

    Args:
        chain: A NAO's arm; of five joints, with the wrist yaw locked.
        target: A position (3,) [m].
        locked: Values of other joints by name [rad].

    Returns:
        Intervals by branch, ascending; empty if no elbow yaw will do. For any value inside one, `nao_kin.solve_all`
        with the elbow yaw locked there has a solution of that branch within limits. An elbow yaw without limits runs
        through [−π, π].

    Raises:
        InvalidInputError: The target is no position, or the chain no such arm.
        UnknownNameError: A locked joint is not one of the chain; carries near matches.
    """
    wanted = Target.of(target)
    if wanted.kind != "position":
        raise InvalidInputError("target", "a position, which is what leaves the elbow yaw free", f"a {wanted.kind}")
    found, free = _arm(chain, wanted, dict(locked or {}))
    lower, upper = max(float(chain.lower[free]), -math.pi), min(float(chain.upper[free]), math.pi)
    critical = [y for y in _critical(found, chain, wanted) if lower < y < upper]
    edges = [lower, *sorted(critical), upper]
    edges = [edge for edge, before in zip(edges, [-math.inf, *edges], strict=False) if edge - before > _SAME]
    whole: dict[int, list[list[float]]] = {}
    for left, right in itertools.pairwise(edges):
        for label in _inside_at(found, chain, wanted, 0.5 * (left + right)):
            pieces = whole.setdefault(label, [])
            if pieces and pieces[-1][1] == left:
                pieces[-1][1] = right
            else:
                pieces.append([left, right])
    found_in = [Interval(a, b, found.form.labels[label]) for label, pieces in whole.items() for a, b in pieces]
    return tuple(sorted(found_in, key=lambda interval: (interval.lower, interval.branch)))


def _arm(chain: Chain, wanted: Target, locked: dict[str, float]) -> tuple[Matched, int]:
    """The arm's form, and the chain's column of the elbow yaw."""
    for name in (name for name in chain.joint_names if name not in locked):
        try:
            found = matched(chain, wanted, {**locked, name: 0.0})
        except InvalidInputError:
            continue
        if found.form.name.startswith("nao_arm") and found.columns[_ELBOW_YAW] == chain.joint_names.index(name):
            return found, found.columns[_ELBOW_YAW]
    raise InvalidInputError(
        "chain", "a NAO's arm with every joint locked that its position leaves free, the elbow yaw apart", chain.name
    )


def _inside_at(found: Matched, chain: Chain, wanted: Target, yaw: float) -> Iterator[int]:
    """Numbers of the branches that are within limits at this elbow yaw."""
    n, given = found.form.joints, found.given[0].copy()
    given[0] = yaw
    rows = np.empty((found.request.branches, n + 2))
    goal = np.ascontiguousarray(wanted.goal)
    count = found.form.solve(found.geometry.parameters, GOALS["position"], goal, given, 0.0, rows)
    for row in rows[:count]:
        q = found.template.copy()
        q[list(found.columns)] = row[:n]
        if not outside_limits(chain, placed(q, found.ranges)):
            yield int(row[n])


@dataclass(frozen=True, eq=False, slots=True)
class _Reach:
    """The arm and the position as numbers; vectors in shoulder axes [m].

    Attributes:
        e: The position seen from the shoulder.
        upper: The upper arm (L, o).
        h: The tip seen from the elbow point, in the forearm's axes, wrist yaw included.
        dot: What (Rz(θ2)ᵀ Ry(θ1)ᵀ e) · (L, o, 0) must be, for the hand to be as long as it is.
    """

    e: Floats
    upper: Floats
    h: Floats
    dot: float

    @classmethod
    def of(cls, found: Matched, wanted: Target) -> _Reach:
        p = found.geometry.parameters
        e = p[BASE:SHOULDER].reshape(3, 3).T @ (wanted.goal[:3, 3] - p[SHOULDER:LENGTH])
        upper, (x, y, z) = p[LENGTH : OFFSET + 1], p[TIP : TIP + 3]
        c, s = (math.cos(w), math.sin(w)) if (w := float(found.given[0, -1])) and found.form.joints == 5 else (1.0, 0.0)
        h = np.array([x, c * y - s * z, s * y + c * z])
        return cls(e, upper, h, 0.5 * float(e @ e + upper @ upper - h @ h))


def _critical(found: Matched, chain: Chain, wanted: Target) -> list[float]:
    """Every elbow yaw at which a branch may enter or leave the limits, begin or end [rad]."""
    if chain.limit_rules:
        raise InvalidInputError("chain", "a chain without coupled limits", chain.name)
    reach, shift = _Reach.of(found, wanted), found.geometry.parameters[SHIFTS : SHIFTS + 5]

    def ends(joint: int) -> list[float]:
        column = found.columns[joint]
        return [x + shift[joint] for x in (chain.lower[column], chain.upper[column]) if math.isfinite(x)]

    yaws = [yaw for t4 in ends(_ELBOW_ROLL) for yaw in _yaws_at_elbow_roll(reach, t4)]
    yaws += [yaw for t2 in ends(_ROLL) for g in _hands_at_roll(reach, t2) for yaw in _yaws_of_hand(reach, g)]
    yaws += [yaw for t1 in ends(_PITCH) for g in _hands_at_pitch(reach, t1) for yaw in _yaws_of_hand(reach, g)]
    yaws += [yaw for g in _hands_between_shoulders(reach) for yaw in _yaws_of_hand(reach, g)]
    yaws += _yaws_between_elbows(reach)
    return [math.remainder(yaw - shift[_ELBOW_YAW], 2.0 * math.pi) for yaw in yaws]


def _roots(a: float, b: float, c: float) -> list[tuple[float, float]]:
    """Cosine and sine of every x with a cos x + b sin x = c; none where a and b are 0 and x does not matter."""
    if a == 0.0 == b:
        return []
    count, *values = circle_roots(float(a), float(b), float(c), 0.0)
    pairs: list[Any] = [(values[0], values[1]), (values[2], values[3])]
    return pairs[:count]


def _yaws_at_elbow_roll(reach: _Reach, t4: float) -> Iterator[float]:
    """Elbow yaws with |(L, o, 0) + Rx(θ3) Rz(θ4) h| = |e| for a given θ4."""
    (L, o), (hx, hy, hz), (c4, s4) = reach.upper, reach.h, (math.cos(t4), math.sin(t4))
    rest = reach.dot - float(reach.upper @ reach.upper) - L * (c4 * hx - s4 * hy)
    for c3, s3 in _roots(o * (c4 * hy + s4 * hx), -o * hz, rest):
        yield math.atan2(s3, c3)


def _hands_at_roll(reach: _Reach, t2: float) -> Iterator[Floats]:
    """Hands g = Rx(θ3) Rz(θ4) h that a given shoulder roll leaves, by the pitch."""
    (L, o), (x, y, z), (c2, s2) = reach.upper, reach.e, (math.cos(t2), math.sin(t2))
    mx, my = c2 * L - s2 * o, s2 * L + c2 * o
    for c1, s1 in _roots(mx * x, -mx * z, reach.dot - my * y):
        yield _hand(reach, c1, s1, c2, s2)


def _hands_at_pitch(reach: _Reach, t1: float) -> Iterator[Floats]:
    """The same for a given shoulder pitch, by the roll."""
    (L, o), (x, y, z), (c1, s1) = reach.upper, reach.e, (math.cos(t1), math.sin(t1))
    fx = c1 * x - s1 * z
    for c2, s2 in _roots(L * fx + o * y, L * y - o * fx, reach.dot):
        yield _hand(reach, c1, s1, c2, s2)


def _hand(reach: _Reach, c1: float, s1: float, c2: float, s2: float) -> Floats:
    """The hand g = Rz(−θ2) Ry(−θ1) e − (L, o, 0)."""
    x, y, z = reach.e
    fx, fz = c1 * x - s1 * z, s1 * x + c1 * z
    return np.array([c2 * fx + s2 * y - reach.upper[0], c2 * y - s2 * fx - reach.upper[1], fz])


def _hands_between_shoulders(reach: _Reach) -> Iterator[Floats]:
    """Hands at which the two shoulders meet: the tip is as far from axis 1 as the roll leaves it off its plane."""
    (L, o), across = reach.upper, math.hypot(reach.e[0], reach.e[2])
    left = float(reach.h @ reach.h) - across * across
    if left < 0.0:
        return
    radius = math.sqrt(left)
    for c, s in _roots(L * radius, o * radius, 0.5 * (reach.e[1] ** 2 - L * L - o * o - left)):
        yield np.array([radius * c, radius * s, across])
        yield np.array([radius * c, radius * s, -across])


def _yaws_of_hand(reach: _Reach, g: Floats) -> Iterator[float]:
    """Elbow yaws with Rx(θ3) Rz(θ4) h = g."""
    hx, hy, hz = reach.h
    for c4, s4 in _roots(hx, -hy, g[0]):
        yield math.atan2(g[2], g[1]) - math.atan2(hz, s4 * hx + c4 * hy)


def _yaws_between_elbows(reach: _Reach) -> list[float]:
    """Elbow yaws at which the two elbow rolls meet: (L² + o² cos²θ3) (hx² + hy²) = (K + o hz sin θ3)²."""
    (L, o), (hx, hy, hz) = reach.upper, reach.h
    if o == 0.0:
        return []  # how far the hand reaches does not depend on the elbow yaw
    flat, K = hx * hx + hy * hy, reach.dot - float(reach.upper @ reach.upper)
    sines = np.roots([-o * o * (flat + hz * hz), -2.0 * K * o * hz, (L * L + o * o) * flat - K * K])
    inside = [math.asin(s.real) for s in sines if s.imag == 0.0 and abs(s.real) <= 1.0]
    return [yaw for angle in inside for yaw in (angle, math.pi - angle)]
