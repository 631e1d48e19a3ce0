"""Where a head looks: at a point with the camera's real offset and tilt, or in a direction."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Final

import numpy as np

from nao_kin.analytic.certifying import placed
from nao_kin.analytic.form import GOALS
from nao_kin.analytic.matching import Matched, matched
from nao_kin.analytic.nao import nao_head
from nao_kin.analytic.solutions import Solutions, slack_of, sorted_out
from nao_kin.arrays import Floats, vector
from nao_kin.errors import InvalidInputError
from nao_kin.ik.problem import IKResult, Problem, Run, Status, judge
from nao_kin.ik.target import Target
from nao_kin.tolerances import TOLERANCES, Tolerances

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import ArrayLike

    from nao_kin.chain import Chain

__all__ = ["gaze", "look_at"]

_NO_PLACE: Final = {"x": 0.0, "y": 0.0, "z": 0.0}


def gaze(direction: ArrayLike, tip_axis: ArrayLike = (1.0, 0.0, 0.0)) -> Target:
    """A target that wants an axis of the tip to point in a direction, wherever the tip is.

    Args:
        direction: Where to, in base axes (3,); of any length but 0.
        tip_axis: What is to point there, in tip axes (3,): x of a NAO's camera frame, z of its optical frame.

    Raises:
        InvalidInputError: Not three finite numbers, or of length 0.
    """
    return Target.pointing((0.0, 0.0, 0.0), direction, tip_axis, weights=_NO_PLACE)


def look_at(
    chain: Chain, point: ArrayLike, tip_axis: ArrayLike = (1.0, 0.0, 0.0), *, tolerances: Tolerances = TOLERANCES
) -> Solutions:
    """Every posture of a head in which the camera's axis passes through a point before the camera.

    Args:
        chain: A chain from any base through a NAO's neck to a camera, as ``robot.chain("torso", "CameraTop_frame")``.
        point: What to look at, in the base frame (3,) [m].
        tip_axis: The axis that looks, in tip axes (3,): x of a NAO's camera frame, z of its optical frame.
        tolerances: How far the axis may pass from the point, as an angle [rad] seen from the camera.

    Returns:
        The solutions, judged, those within limits first: the target of each is the direction from where its camera is
        to the point, so ``rotation_error`` is the angle by which the axis misses it. Empty, with a ``reason``, where
        the point is nearer to the neck than the axis ever passes, or would be behind the camera.

    Raises:
        InvalidInputError: Not three finite numbers, or the chain is no such head.
    """
    p, found = vector(point, "point", 3), matched(chain, gaze((1.0, 0.0, 0.0), tip_axis))
    if found.form.name != "nao_head":
        raise InvalidInputError("chain", "a head: yaw and pitch, and a camera", chain.name)
    axis = gaze((1.0, 0.0, 0.0), tip_axis).goal[:3, 0]
    distances = _distances(found, p, axis)
    solutions = sorted_out(result for s in distances for result in _looks(found, chain, p, axis, s, tolerances))
    if not solutions:
        solutions.reason = "The point is behind the camera, or nearer to the neck than the camera's axis passes."
    return solutions


def _distances(found: Matched, point: Floats, axis: Floats) -> list[float]:
    """How far before the camera the point can be [m]: |t + s a| is its distance from the neck."""
    numbers = found.geometry.parameters
    t, a = numbers[nao_head.TIP :], numbers[nao_head.HEAD : nao_head.TIP].reshape(3, 3) @ axis
    d = point - numbers[nao_head.NECK : nao_head.HEAD]
    along = float(t @ a)
    left = along * along - float(t @ t) + float(d @ d)
    if left < 0.0:
        return []
    root = math.sqrt(left)
    return [s for s in {root - along, -root - along} if s > 0.0]


def _looks(
    found: Matched, chain: Chain, point: Floats, axis: Floats, distance: float, tolerances: Tolerances
) -> Iterator[IKResult]:
    """The postures that carry the point on the camera's axis at this distance to where it is to be."""
    numbers = found.geometry.parameters.copy()
    numbers[nao_head.TIP :] += distance * numbers[nao_head.HEAD : nao_head.TIP].reshape(3, 3) @ axis
    goal, rows = np.eye(4), np.empty((2, 4))
    goal[:3, 3] = point
    count = found.form.solve(numbers, GOALS["position"], goal, np.zeros(1), slack_of(tolerances), rows)
    for row in rows[:count]:
        q = placed(row[:2], found.ranges)
        seen = point - chain.pose(q).translation
        problem = Problem(chain, Target.pointing(point, seen, axis, weights=_NO_PLACE), tolerances)
        yield judge(problem, Run(q, Status.SOLVED, branch=found.form.label(int(row[2]), int(row[3]))))
