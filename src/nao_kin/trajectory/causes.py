"""Why a path could not be followed any further, judged at the last joints that were reached."""

from __future__ import annotations

import enum
from typing import TYPE_CHECKING, Final

import numpy as np
import pinocchio as pin

from nao_kin.chain import outside_limits
from nao_kin.ik.problem import Status

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain
    from nao_kin.ik.problem import IKResult
    from nao_kin.ik.target import Target

__all__ = ["NEAR_SINGULAR", "Cause", "cause_of", "singular_values"]

NEAR_SINGULAR: Final = 0.02
"""Least share of the smallest singular value in the largest at which an arm still counts as regular: below it a joint
has to turn fifty times as far as the one that moves the tip best."""

_STRAIGHT: Final = 0.2  # [rad or m]; so far a step to first order is believed even near a singularity
_DAMPING: Final = 1e-3  # of the largest singular value; the step that is tried must stay finite


class Cause(enum.Enum):
    """Why a path ended, as a sentence."""

    NONE = "The path was followed to its end."
    OUT_OF_REACH = "The links are too short for the next sample."
    LIMIT = "A joint would have to go on beyond its limit."
    SINGULARITY = "The arm is at a singularity, where joints have to turn at once for the tip to go on."
    JUMP = "A joint would have to jump."
    NOT_REACHED = "The solver came to no solution near the one before."


def cause_of(chain: Chain, target: Target, q: Floats, result: IKResult) -> tuple[Cause, str]:
    """Why a target is not reached from q without a jump, with the joint and its figures.

    The step to the target is taken to first order. A joint that it carries out of its range is at its limit; where the
    Jacobian's smallest singular value is a small share of its largest, no step of a moderate size leads there.

    Args:
        chain: The chain.
        target: Where to go on.
        q: The last joints that were reached (n,).
        result: What the solver made of it.
    """
    if result.status is Status.OUT_OF_REACH:
        return Cause.OUT_OF_REACH, f"the links are too short by {result.run.misses_by:.3g} m"
    J, missing = _rows(chain, target, q)
    values = np.linalg.svd(J, compute_uv=False)
    damping = (_DAMPING * values[0]) ** 2
    step = J.T @ np.linalg.solve(J @ J.T + damping * np.eye(len(J)), missing)
    beyond, singular = _first_outside(chain, q + step), values[-1] < NEAR_SINGULAR * values[0]
    if beyond and (not singular or np.abs(step).max() < _STRAIGHT):
        return Cause.LIMIT, beyond
    said = f"the smallest singular value of the Jacobian is {values[-1]:.2g}, the largest {values[0]:.2g}"
    if singular:
        return Cause.SINGULARITY, f"the arm is near a singularity, {said}"
    if result.solved:
        return Cause.JUMP, f"away from limits and singularities, {said}"
    return Cause.NOT_REACHED, result.message.rstrip(".")


def singular_values(chain: Chain, target: Target, q: Floats) -> Floats:
    """Singular values, largest first, of the Jacobian's rows that a target binds [m and rad, a rad]."""
    return np.asarray(np.linalg.svd(_rows(chain, target, q)[0], compute_uv=False))


def _rows(chain: Chain, target: Target, q: Floats) -> tuple[Floats, Floats]:
    """The Jacobian's rows (m, n) that a target binds, and what is missing along them (m,), both in base axes."""
    T_base_tip, J = chain.pose(q), chain.jacobian(q)
    place = target.goal[:3, 3] - T_base_tip.translation
    counted = np.array(target.weights) > 0.0
    if target.kind == "position":
        return J[:3][counted[:3]], place[counted[:3]]
    if target.kind == "orientation":
        return J[3:][counted[3:]], _turn(target, T_base_tip)[counted[3:]]
    if target.kind == "pose":
        return J[counted], np.concatenate([place, _turn(target, T_base_tip)])[counted]
    axis, wanted = T_base_tip.rotation @ target.goal[:3, 0], target.goal[:3, 1]
    across = np.linalg.svd(axis[None])[2][1:]  # two directions across the axis: turning about it is free
    used, missing = np.vstack([J[:3], across @ J[3:]]), np.concatenate([place, across @ np.cross(axis, wanted)])
    return used[counted[:5]], missing[counted[:5]]


def _turn(target: Target, T_base_tip: pin.SE3) -> Floats:
    """The rotation vector (3,) that is missing, in base axes."""
    return np.asarray(pin.log3(target.goal[:3, :3] @ T_base_tip.rotation.T))


def _first_outside(chain: Chain, q: Floats) -> str:
    """The joint that is farthest outside its own or its coupled range, in words; empty where none is."""
    outside = outside_limits(chain, q)
    if not outside:
        return ""
    worst = max(outside, key=lambda joint: max(joint.lower - joint.value, joint.value - joint.upper))
    end, limit = ("upper", worst.upper) if worst.value > worst.upper else ("lower", worst.lower)
    return f"{worst.joint} is at its {end} limit {limit:.6g} and would have to go on"
