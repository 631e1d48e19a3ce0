"""How the hexapod article is measured: leg by leg on the PhantomX (Pinocchio), every other quantity exact."""

from __future__ import annotations

import itertools
import math
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from nao_kin.documents import hexapod_article as forms
from nao_kin.documents.claim import Measured
from nao_kin.documents.hexapod_walker import body_poses, foot_of, phantomx, placed, stances, walker
from nao_kin.documents.samples import deviation, wrapped
from nao_kin.se3 import rotation_x, rotation_y, rotation_z

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from nao_kin.arrays import Floats
    from nao_kin.documents.claim import Check, Form
    from nao_kin.documents.hexapod_walker import Leg, Stance

    Call = Callable[[Form, Stance, int], Any]
    Wanted = Callable[[Leg], float]

COUNT, _SEED = 40, 200
_FORWARD: Final = np.array([1.0, 0.0, 0.0])
_UP: Final = np.array([0.0, 0.0, 1.0])


def _turns() -> Iterator[Floats]:
    yield from np.random.default_rng(_SEED).uniform(-1.0, 1.0, (200, 3))


def matrix(form: Form) -> Measured:
    """The rotation matrix, and what is wrong with it column by column."""
    errors, skew, columns = list[float](), list[float](), list[float]()
    for turn in _turns():
        wanted, M = placed(turn, np.zeros(3)).rotation, form(*turn)
        errors.append(deviation(M, wanted))
        columns.append(deviation(M[:, :2], wanted[:, :2]))
        skew.append(deviation(M.T @ M, np.eye(3)))
    found = (
        f"First two columns: off by up to {max(columns):.2g}, so points with z = 0 come out right; third column by "
        f"up to {max(errors):.3g}. MᵀM departs from the unit matrix by up to {max(skew):.3g}."
    )
    turns = list(_turns())
    return Measured.worst(errors, lambda k: "α, β, γ = {:.2f}, {:.2f}, {:.2f} rad".format(*turns[k]), found)


def order(form: Form) -> Measured:
    """The first two columns of the printed matrix, which are right, tell the order; other orders for comparison."""
    errors, others = list[float](), list[float]()
    hips = walker()[0]
    for turn in _turns():
        parts = [
            rotation(angle).rotation for rotation, angle in zip((rotation_x, rotation_y, rotation_z), turn, strict=True)
        ]
        R = form(*parts)
        errors.append(deviation(R[:, :2], forms.rotation_matrix(*turn)[:, :2]))
        for order in itertools.permutations(range(3)):
            if order != (2, 0, 1):
                other = parts[order[0]] @ parts[order[1]] @ parts[order[2]]
                others.append(float(np.linalg.norm(hips @ (other - R).T, axis=1).max()))
    found = (
        f"Any of the five other orders puts a hip servo elsewhere by up to {max(others):.0f} mm, at turns up to 1 rad."
    )
    return Measured.worst(errors, found=found)


def plane(form: Form) -> Measured:
    """Parallel to the turned plane of the hip servos and at the distance Δ from it."""
    hips, rng, errors, printed = walker()[0], np.random.default_rng(_SEED), list[float](), list[float]()
    for turn, moved in body_poses(COUNT, _SEED):
        delta, T = float(rng.uniform(-100.0, 100.0)), placed(turn, moved)
        real = np.array([T.act(p) for p in hips])
        normal = np.cross(real[3] - real[5], real[0] - real[3])
        shift = delta * normal / np.linalg.norm(normal)
        shifted = form(hips, delta)
        errors.append(deviation([T.act(p) for p in shifted], real + shift) / abs(delta))
        M = forms.rotation_matrix(*turn)
        printed.append(float(np.linalg.norm(M @ (shifted - hips)[0] - shift)) / abs(delta))
    found = f"With the printed matrix the plane is up to {100.0 * max(printed):.0f} % of Δ from where it should be."
    return Measured.worst(errors, found=found)


def leg_by_leg(call: Call, wanted: Wanted, keep: Callable[[Leg], bool] = lambda leg: leg.below > 0.05) -> Check:
    """One angle [rad] of every leg of every stance."""

    def check(form: Form) -> Measured:
        errors = [
            float(wrapped(call(form, stance, k) - wanted(leg)))
            for stance in stances(COUNT, _SEED)
            for k, leg in enumerate(stance.legs)
            if keep(leg)
        ]
        return Measured.worst(errors)

    return check


def _servos(stance: Stance, k: int) -> tuple[Floats, Floats, Floats]:
    """Hip servo, its virtual twin and the foot on the ground."""
    hip = stance.legs[k].hip
    return stance.T.act(hip), stance.T.act(hip + 50.0 * _UP), stance.feet[k]


def hip_forward(form: Form, stance: Stance, k: int) -> Any:
    """Calls a hip angle with “along” pointing forward."""
    return form(*_servos(stance, k), stance.T.rotation @ _FORWARD)


def hip_rearward(form: Form, stance: Stance, k: int) -> Any:
    """Calls it with “along” pointing back."""
    return form(*_servos(stance, k), -stance.T.rotation @ _FORWARD)


def signed(leg: Leg) -> float:
    """Of the hip, from the forward direction."""
    return float(leg.angles[0])


def outward(leg: Leg) -> float:
    """Of the hip, outwards on both sides."""
    return abs(float(leg.angles[0]))


def rise(leg: Leg) -> float:
    """Of the thigh, above the body's plane."""
    return float(leg.angles[1])


def knee(leg: Leg) -> float:
    """Inner angle of the knee."""
    return float(leg.angles[2])


def at_thigh(leg: Leg) -> float:
    """Between thigh and g."""
    return leg.at_thigh


def below(leg: Leg) -> float:
    """From the body's plane down to g."""
    return leg.below


def thigh(form: Form) -> Measured:
    """The thigh servo in the body, in units of the hip."""
    hip, errors = walker()[1], list[float]()
    for stance in stances(COUNT, _SEED):
        for leg in stance.legs:
            errors.append(deviation(form(leg.hip, leg.angles[0], hip), leg.thigh) / hip)
    return Measured.worst(errors)


def _g(stance: Stance, k: int) -> Floats:
    return np.asarray(stance.feet[k] - stance.T.act(stance.legs[k].thigh))


def triangle(form: Form, stance: Stance, k: int) -> Any:
    """Calls a1 or a2."""
    _, _, thigh, shin = walker()
    return form(thigh, shin, float(np.linalg.norm(_g(stance, k))))


def h_to_foot(form: Form, stance: Stance, k: int) -> Any:
    """Calls a4 with h from the hip servo to the foot."""
    return form(stance.feet[k] - stance.T.act(stance.legs[k].hip), _g(stance, k))


def h_to_thigh(form: Form, stance: Stance, k: int) -> Any:
    """Calls a4 with h from the hip servo to the thigh servo."""
    return form(stance.T.rotation @ (stance.legs[k].thigh - stance.legs[k].hip), _g(stance, k))


def difference(form: Form, stance: Stance, k: int) -> Any:
    """Calls a3."""
    return form(stance.legs[k].at_thigh, stance.legs[k].below)


def struck(form: Form) -> Measured:
    """Distance of each angle said to be a joint's from the nearer one of thigh and knee, and of those from it."""
    errors = []
    for stance in stances(COUNT, _SEED):
        for leg in stance.legs:
            joints = leg.angles[1:]
            said = form(leg.angles[2], leg.at_thigh, leg.angles[1], leg.below)
            errors += [min(abs(angle - joint) for joint in joints) for angle in said]
            errors += [min(abs(angle - joint) for angle in said) for joint in joints]
    return Measured.worst(
        errors, found="a1 is the knee's angle and a3 the thigh's; a leg's third joint is the hip's α."
    )


def count(form: Form) -> Measured:
    """Moving joints of the robot."""
    joints = len(phantomx().joint_names)
    return Measured.worst([form() - joints], found=f"Six legs of three joints: {joints}.")


def whole(form: Form) -> Measured:
    """How far the feet of the computed angles are from where they should stay [mm]."""
    hips, *lengths = walker()
    errors, tilts = list[float](), list[str]()
    alone = {name: list[float]() for name in ("α", "β", "γ")}
    for stance in stances(COUNT, _SEED):
        errors += _foot_errors(form, hips, tuple(lengths), stance.turn, stance.moved, stance.legs)
        for k, name in enumerate(alone):
            turn = np.where(np.arange(3) == k, stance.turn, 0.0)
            alone[name] += _foot_errors(form, hips, tuple(lengths), turn, stance.moved, stance.legs)
    tilts = [f"{name} alone {max(found):.3g} mm" for name, found in alone.items()]
    near = sum(error <= 0.1 for error in errors)
    found = (
        f"{near} of {len(errors)} feet within 0.1 mm; {float(np.median(errors)):.3g} mm off in the median, "
        f"{max(errors):.3g} mm at most.\nWith one turn only, at most: {', '.join(tilts)}."
    )
    return Measured.worst(errors, lambda k: f"pose {k // 6 + 1}, leg {k % 6 + 1}", found)


def _foot_errors(
    form: Form, hips: Floats, lengths: tuple[float, ...], turn: Floats, moved: Floats, legs: tuple[Leg, ...]
) -> list[float]:
    """Distances of six feet [mm]; a leg without angles leaves its foot a thigh's length away at least."""
    T = placed(turn, moved)
    feet = np.array([T.act(leg.foot) for leg in legs])
    angles = form(hips, lengths, turn, moved, feet)
    reached = foot_of(np.nan_to_num(angles))
    errors = [math.dist(T.act(p), foot) for p, foot in zip(reached, feet, strict=True)]
    return [e if np.isfinite(row).all() else max(e, lengths[1]) for e, row in zip(errors, angles, strict=True)]
