"""The bent wrist's one equation, sampled far more densely than its solver does, and on singular poses."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from nao_kin.analytic.six_r.six_r_bent_wrist import BRANCHES, SAMPLES, solve_densely
from nao_kin.bench.sheet import Goal, Heading, Sheet
from nao_kin.kernels.audit import tips

if TYPE_CHECKING:
    from collections.abc import Iterator

    from nao_kin.analytic.matching import Matched
    from nao_kin.arrays import Floats
    from nao_kin.robot.urdf_chain import UrdfChain

__all__ = ["dense_and_singular"]

_DENSER: Final = 20
_SAME: Final = 1e-5  # [rad]
_SLACK: Final = 1e-6  # [m]
_BISECTIONS: Final = 70
_ALIGNED: Final = 4  # joint
_HEADINGS = (
    Heading("poses", "poses"),
    Heading("targets", "number", "d"),
    Heading("branches", "branches", ".3f"),
    Heading("most", "most", "d"),
    Heading("none", "none", "d"),
    Heading("lost", "lost", "d"),
    Heading("denser", "denser", "d"),
    Heading("residual", "residual", ".0e"),
)


def dense_and_singular(
    chain: UrdfChain, found: Matched, targets: int, rng: np.random.Generator
) -> tuple[Sheet, list[Goal]]:
    """The sheet, and what is demanded of it: random poses, and a twentieth as many of each singular family."""
    families = [("random", rng.uniform(-np.pi, np.pi, (targets, 6))), *_families(chain, max(50, targets // 20), rng)]
    rows = [_row(chain, found, name, Q) for name, Q in families]
    demanded = [
        Goal(f"JACO2, poses {words}", sum(row[key] for row in rows), 0.0, at_least=False)
        for key, words in (
            ("none", "without solution"),
            ("lost", "that lose their own joints"),
            ("denser", "with more solutions when sampled more densely"),
        )
    ]
    title = (
        f"every branch of JACO2: poses with none, poses that lose their own joints, and poses of which {_DENSER} times "
        "denser samples find more"
    )
    return Sheet("bent", title, _HEADINGS, rows), demanded


def _row(chain: UrdfChain, found: Matched, name: str, Q: Floats) -> dict[str, Any]:
    goals, arm = chain.poses(Q), found.geometry.parameters
    rows, counts = np.zeros((len(Q), BRANCHES, 8)), np.zeros(len(Q), dtype=np.int64)
    more, denser = np.zeros_like(rows), np.zeros_like(counts)
    found.form.solve_many(arm, 0, goals, np.zeros((1, 1)), _SLACK, rows, counts)
    solve_densely(arm, _DENSER * SAMPLES, goals, more, denser)
    known = [q[:count, :6] for q, count in zip(rows, counts, strict=True)]
    reached = tips(chain.joint_path, np.ascontiguousarray(np.concatenate(known)))
    return {
        "poses": name,
        "targets": len(Q),
        "branches": float(counts.mean()),
        "most": int(counts.max()),
        "none": int((counts == 0).sum()),
        "lost": sum(_apart(ours, q) > _SAME for ours, q in zip(known, Q, strict=True)),
        "denser": sum(
            any(_apart(ours, q) > _SAME for q in theirs[:count, :6])
            for ours, theirs, count in zip(known, more, denser, strict=True)
        ),
        "residual": float(np.abs(reached - np.repeat(goals, counts, axis=0)).max()),
    }


def _apart(known: Floats, q: Floats) -> float:
    """Largest joint move from q to the nearest of some solutions, whole turns left out [rad]."""
    moves = np.abs((known - q + np.pi) % (2.0 * np.pi) - np.pi).max(axis=1, initial=0.0)
    return float(moves.min(initial=math.inf))


def _families(chain: UrdfChain, count: int, rng: np.random.Generator) -> Iterator[tuple[str, Floats]]:
    """Joints (count, 6) of exactly singular poses, and of others where the arm is straight, aligned or rectangular."""
    for joint in range(1, 5):
        yield f"singular by joint {joint + 1}", _singular(chain, joint, count, rng)
    aligned = rng.uniform(-np.pi, np.pi, (count, 6))
    aligned[:, _ALIGNED] = math.pi * rng.integers(0, 2, count)
    yield "wrist aligned", aligned
    for name, parts in (("quarter turns", 2), ("eighth turns", 4)):
        turns = rng.integers(-parts, parts + 1, (count, 6)).astype(np.float64)
        yield name, turns * (math.pi / parts)


def _singular(chain: UrdfChain, joint: int, count: int, rng: np.random.Generator) -> Floats:
    """Joints (count, 6) at which the determinant of the Jacobian changes its sign as one joint turns."""
    made: list[Floats] = []
    while sum(map(len, made)) < count:
        Q = rng.uniform(-np.pi, np.pi, (1000, 6))
        low = Q[:, joint].copy()
        high = low + 0.2
        start = _determinants(chain, Q, joint, low)
        change = (start < 0.0) != (_determinants(chain, Q, joint, high) < 0.0)
        Q, low, high, start = Q[change], low[change], high[change], start[change]
        for _ in range(_BISECTIONS):
            middle = 0.5 * (low + high)
            same = (_determinants(chain, Q, joint, middle) < 0.0) == (start < 0.0)
            low, high = np.where(same, middle, low), np.where(same, high, middle)
        Q[:, joint] = low
        made.append(Q)
    return np.concatenate(made)[:count]


def _determinants(chain: UrdfChain, Q: Floats, joint: int, values: Floats) -> Floats:
    moved = Q.copy()
    moved[:, joint] = values
    return np.asarray(np.linalg.det(chain.jacobians(moved)))
