"""A scene's joints, postures and motion as JSON for the page's script; its triangles go in meshcat's commands.

Nodes, joints and chains are numbers: their order in the scene. A name stands only where it is to be read.
"""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from nao_kin.arrays import Floats
    from nao_kin.urdf.elements import Colour
    from nao_kin.view.scene import NamedPosture, Node, Rod, Scene, SceneGoal, SceneJoint, SceneLeg, SceneMotion

__all__ = ["scene_json"]


def scene_json(scene: Scene) -> bytes:
    """The scene without its triangles, as JSON in UTF-8; numbers in full, except that −∞, ∞ and NaN are null."""
    number = {joint.name: index for index, joint in enumerate(scene.joints)}
    values = {joint.name: joint.value for joint in scene.joints}
    data = {
        "title": scene.title,
        "nodes": [_node(node, number) for node in scene.nodes],
        "joints": [_joint(joint, number) for joint in scene.joints],
        "rules": [
            {
                "joint": number[rule.joint],
                "by": number[rule.by],
                "at": list(rule.at),
                "lower": list(rule.lower),
                "upper": list(rule.upper),
                "even": rule.even,
            }
            for rule in scene.rules
        ],
        "groups": [{"title": title, "joints": [number[name] for name in names]} for title, names in scene.groups],
        "chains": [{"name": chain.name, "base": chain.base, "tip": chain.tip} for chain in scene.chains],
        "postures": [_posture(posture, values) for posture in scene.postures],
        "columns": list(scene.posture_columns),
        "ghosts": scene.ghosts,
        "goals": [_goal(goal) for goal in scene.goals],
        "motion": None if scene.motion is None else _motion(scene.motion, number),
        "rods": [_rod(rod) for rod in scene.rods],
        "framed": list(scene.framed),
        "legs": [_leg(leg, number) for leg in scene.legs],
    }
    return json.dumps(data, separators=(",", ":"), ensure_ascii=False, allow_nan=False).encode("utf-8", "replace")


def _node(node: Node, number: Mapping[str, int]) -> dict[str, Any]:
    drive = node.drive
    return {
        "label": node.label,
        "parent": -1 if node.parent is None else node.parent,
        "placement": _columns(node.placement),
        "collides": node.collides,
        "drive": None
        if drive is None
        else {
            "joint": number[drive.joint],
            "axis": list(map(float, drive.axis)),
            "slides": drive.slides,
            "multiplier": drive.multiplier,
            "offset": drive.offset,
        },
    }


def _joint(joint: SceneJoint, number: Mapping[str, int]) -> dict[str, Any]:
    return {
        "name": joint.name,
        "slides": joint.kind == "prismatic",
        "kind": joint.kind,
        "value": joint.value,
        "lower": _finite(joint.lower),
        "upper": _finite(joint.upper),
        "velocity": _finite(joint.max_velocity),
        "leader": -1 if joint.leader is None else number[joint.leader],
        "multiplier": joint.multiplier,
        "offset": joint.offset,
    }


def _posture(posture: NamedPosture, values: Mapping[str, float]) -> dict[str, Any]:
    return {
        "name": posture.name,
        "values": [posture.values.get(name, value) for name, value in values.items()],
        "cells": list(posture.cells),
        "good": posture.good,
    }


def _goal(goal: SceneGoal) -> dict[str, Any]:
    return {
        "chain": goal.chain,
        "kind": goal.kind,
        "placement": _columns(goal.T_base_target),
        "counts": list(goal.counts),
        "tipAxis": goal.tip_axis,
        "baseAxis": goal.base_axis,
    }


def _motion(motion: SceneMotion, number: Mapping[str, int]) -> dict[str, Any]:
    return {
        "name": motion.name,
        "joints": [number[name] for name in motion.joints],
        "times": motion.times.tolist(),
        "q": motion.q.tolist(),
        "iterates": motion.iterates,
        "curves": [{"name": c.name, "unit": c.unit, "y": _finite_all(c.y.tolist())} for c in motion.curves],
        "tips": list(motion.tips),
        "starts": None if motion.starts is None else motion.starts.tolist(),
        "body": None if motion.body is None else [_columns(pose) for pose in motion.body],
    }


def _rod(rod: Rod) -> dict[str, Any]:
    return {
        "start": rod.start,
        "end": rod.end,
        "colour": _hexadecimal(rod.colour),
        "radius": rod.radius,
        "measured": rod.measured,
    }


def _leg(leg: SceneLeg, number: Mapping[str, int]) -> dict[str, Any]:
    return {
        "name": leg.name,
        "base": leg.base,
        "foot": leg.foot,
        "joints": [number[name] for name in leg.joints],
        "numbers": list(leg.numbers),
    }


def _columns(pose: Floats) -> list[float]:
    """A (4, 4) pose column by column, as the viewer has it."""
    numbers: list[float] = pose.T.reshape(-1).tolist()
    return numbers


def _hexadecimal(colour: Colour) -> int:
    red, green, blue = (round(255.0 * min(max(channel, 0.0), 1.0)) for channel in colour[:3])
    return (red << 16) + (green << 8) + blue


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _finite_all(values: Iterable[float]) -> list[float | None]:
    return [_finite(value) for value in values]
