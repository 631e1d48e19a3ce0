"""How far a joint can carry a shape, whatever the posture: the bound that makes a clearance hold between samples.

If joint k turns by Δ, no point moves farther than |Δ| times its distance from the axis, and that distance never exceeds
the lengths of the links between, summed. So along any motion the distance between two bodies falls by at most
Σ lever_k |Δ_k| over the joints between them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from nao_kin.arrays import Floats
    from nao_kin.collision.shapes import Body
    from nao_kin.robot.motors import Motors

__all__ = ["pair_levers"]


def pair_levers(motors: Motors, bodies: Sequence[Body], pairs: Sequence[tuple[int, int]]) -> Floats:
    """Levers (P, n) of every pair for every motor [m/rad, or m/m for prismatic joints].

    A motor that moves neither body against the other has lever 0.
    """
    to_body = [_levers(motors, body) for body in bodies]
    levers = np.zeros((len(pairs), len(motors.joints)))
    for row, (i, j) in enumerate(pairs):
        apart = set(to_body[i]) ^ set(to_body[j])  # joints above both move them alike
        for body in (i, j):
            for joint, lever in to_body[body].items():
                if joint in apart:
                    levers[row] += lever * np.abs(motors.spread[joint])
    return levers


def _levers(motors: Motors, body: Body) -> dict[int, float]:
    """For each moving joint above a body, by its place in file order, how far from its axis the body may ever be."""
    model, names, found, distance, joint = motors.robot.model, motors.robot.joint_names, {}, body.reach, body.joint
    while joint:
        place = names.index(model.names[joint])
        prismatic = motors.robot.moving_joints[place].kind == "prismatic"
        found[place] = 1.0 if prismatic else distance
        if prismatic:
            distance += _travel(motors, place)
        distance += float(np.linalg.norm(model.jointPlacements[joint].translation))
        joint = model.parents[joint]
    return found


def _travel(motors: Motors, place: int) -> float:
    """Greatest offset of a prismatic joint from its zero [m]; infinite where it has no limits."""
    row, shift = motors.spread[place], motors.shift[place]
    (column,) = np.flatnonzero(row)
    return float(max(abs(row[column] * end + shift) for end in (motors.lower[column], motors.upper[column])))
