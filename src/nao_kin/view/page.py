"""A scene as one HTML page that needs no server, no network and no installation.

The page carries meshcat's viewer, the recorded commands and its own small script. Its Content-Security-Policy allows
exactly these two scripts, by their hashes, and no connection at all.
"""

from __future__ import annotations

import base64
import functools
import hashlib
import html
import importlib.metadata
import importlib.resources
import json
import math
import re
import zlib
from typing import TYPE_CHECKING, Any, Final

from nao_kin.view.record import recorded

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from nao_kin.arrays import Floats
    from nao_kin.urdf.elements import Colour
    from nao_kin.view.scene import NamedPosture, Node, Panel, Rod, Scene, SceneGoal, SceneJoint, SceneLeg, SceneMotion

__all__ = ["page", "scene_json"]


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


MINUS = "\N{MINUS SIGN}"

SCRIPT_PARTS: Final = (
    "data",
    "matrix",
    "state",
    "camera",
    "stage",
    "marks",
    "labels",
    "elements",
    "units",
    "joints",
    "tip",
    "postures",
    "exchange",
    "chart",
    "player",
    "leg",
    "body",
    "toolbar",
    "printing",
    "main",
)
"""Files of the page's script, in the order in which they stand in it."""


def page(scene: Scene) -> str:
    """The page, complete. The same scene gives the same text, byte for byte.

    Text of the scene (names, notes) occurs in it only HTML-escaped or in compressed data.
    """
    viewer, viewer_hash = _viewer()
    script, script_hash = _own_script()
    policy = (
        f"default-src 'none'; script-src {viewer_hash} {script_hash}; "
        "style-src 'unsafe-inline'; img-src data: blob:; base-uri 'none'; form-action 'none'"
    )
    return _filled(
        _resource("page.html"),
        {
            "policy": policy,
            "title": html.escape(scene.title),
            "version": html.escape(_version()),
            "style": _resource("page.css"),
            "source": _source(scene),
            "produced": html.escape(scene.produced),
            "panels": "\n".join(map(_text_panel, scene.panels)),
            "joints": _joint_table(scene.joints),
            "notes": _note_panel(scene.notes),
            "data": _json_text(_packed([scene_json(scene), *recorded(scene)])),
            "viewer": viewer,
            "script": script,
        },
    )


def _filled(template: str, values: dict[str, str]) -> str:
    """The template with every `{{name}}` replaced in one pass, so that a value is never searched for names."""
    text = re.sub(r"\{\{(\w+)\}\}", lambda match: values[match[1]], template)
    return text.encode("utf-8", "replace").decode("utf-8")  # half a surrogate pair, in a name, cannot be written


def _source(scene: Scene) -> str:
    if not scene.source:
        return ""
    digest = html.escape(scene.sha256)
    short = f', sha256 <code title="{digest}">{digest[:12]}</code>' if digest else ""
    return f'<p>Robot from <span class="file">{html.escape(scene.source)}</span>{short}</p>'


def _joint_table(joints: tuple[SceneJoint, ...]) -> str:
    """For readers without scripts; the page's own makes sliders instead."""
    rows = "\n".join(_joint_row(joint) for joint in joints)
    return (
        '<table><thead><tr><th scope="col">joint</th><th scope="col">rad</th>'
        f'<th scope="col">deg</th></tr></thead><tbody>\n{rows}\n</tbody></table>'
    )


def _joint_row(joint: SceneJoint) -> str:
    if joint.kind == "prismatic":
        first, second = f"{_number(joint.value, 4)} m", f"{_number(1e3 * joint.value, 1)} mm"
    else:
        first, second = _number(joint.value, 4), f"{_number(math.degrees(joint.value), 2)}°"
    return f'<tr><th scope="row">{html.escape(joint.name)}</th><td>{first}</td><td>{second}</td></tr>'


def _number(value: float, digits: int) -> str:
    text = f"{value:.{digits}f}"
    if float(text) == 0.0:
        text = text.lstrip("-")  # no "−0.0000"
    return text.replace("-", MINUS)


def _text_panel(panel: Panel) -> str:
    paragraphs = "".join(f"<p>{html.escape(line)}</p>" for line in panel.lines)
    return (
        f'<details class="section"{" open" if panel.open else ""}><summary>{html.escape(panel.title)}</summary>\n'
        f'<div class="text">{paragraphs}</div></details>'
    )


def _note_panel(notes: tuple[str, ...]) -> str:
    if not notes:
        return ""
    items = "".join(f"<li>{html.escape(note)}</li>" for note in notes)
    return (
        f'<details class="section" id="notes"><summary>Notes <span class="count">{len(notes)}</span></summary>\n'
        f'<div class="text"><ul>{items}</ul></div></details>'
    )


def _packed(commands: list[bytes]) -> dict[str, object]:
    """The commands in a form the page can take apart: text, since a page holds no bytes, of about a third the size."""
    deflated = base64.b64encode(zlib.compress(b"".join(commands), 6)).decode("ascii")
    return {"lengths": [len(command) for command in commands], "deflated": deflated}


def _json_text(value: object) -> str:
    """JSON that cannot end the script element it stands in."""
    return json.dumps(value, separators=(",", ":")).replace("<", "\\u003c")


@functools.cache
def _viewer() -> tuple[str, str]:
    """The viewer that meshcat bundles, behind the licences it comes under, and its hash for the policy."""
    dist = importlib.resources.files("meshcat") / "viewer"
    licence = (dist / "LICENSE").read_text(encoding="utf-8").replace("*/", "* /").strip()
    notices = (dist / "dist" / "main.min.js.LICENSE.txt").read_text(encoding="utf-8").strip()
    script = (dist / "dist" / "main.min.js").read_text(encoding="utf-8").strip()
    text = _script_text(f"/* meshcat\n\n{licence}\n*/\n{notices}\n{script}")
    return text, _source_hash(text)


@functools.cache
def _own_script() -> tuple[str, str]:
    """The page's own script, its parts in one scope, and its hash for the policy."""
    parts = "\n".join(_resource(f"js/{name}.js") for name in SCRIPT_PARTS)
    text = _script_text(f'(() => {{\n"use strict";\n{parts}\n}})();')
    return text, _source_hash(text)


def _script_text(script: str) -> str:
    """Script text in a form that neither ends its element nor starts a comment; both only occur within literals."""
    script = script.replace("\r\n", "\n").replace("\r", "\n")  # browsers read, and hash, the text this way
    script = re.sub(r"</(?=script)", r"<\\/", script, flags=re.IGNORECASE).replace("<!--", "<\\!--")
    return f"\n{script}\n"


def _source_hash(script: str) -> str:
    digest = hashlib.sha256(script.encode("utf-8")).digest()
    return f"'sha256-{base64.b64encode(digest).decode('ascii')}'"


@functools.cache
def _resource(name: str) -> str:
    return (importlib.resources.files("nao_kin.view") / name).read_text(encoding="utf-8")


def _version() -> str:
    try:
        return importlib.metadata.version("nao_kin")
    except importlib.metadata.PackageNotFoundError:  # run from a source tree
        return "(not installed)"
