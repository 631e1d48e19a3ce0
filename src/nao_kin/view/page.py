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
from typing import TYPE_CHECKING, Final

from nao_kin.view.record import recorded
from nao_kin.view.scene_data import scene_json

if TYPE_CHECKING:
    from nao_kin.view.scene import Panel, Scene, SceneJoint

__all__ = ["page"]

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
