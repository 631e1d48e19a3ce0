"""The page as text: reproducible, closed, and deaf to hostile names."""

from __future__ import annotations

import base64
import hashlib
import html
import io
import json
import re
import subprocess
import sys
import zlib
from html.parser import HTMLParser

import numpy as np
import umsgpack

from nao_kin.robot.robot import Robot, load
from nao_kin.view.page import page
from nao_kin.view.record import node_paths, recorded
from nao_kin.view.robot_scene import robot_scene
from nao_kin.view.scene import Node, Scene, SceneJoint

HOSTILE = [
    "</script><script>alert(1)</script>",
    "<!--<script>",
    "<img src=x onerror=alert(1)>",
    '" onclick="alert(1)',
    "__proto__",
    "constructor",
    "a//b",
    "{{data}}",
    "javascript:alert(1)",
]


class Tags(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.seen: list[tuple[str, dict[str, str | None]]] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.seen.append((tag, dict(attrs)))


def tags(text: str) -> list[tuple[str, dict[str, str | None]]]:
    parser = Tags()
    parser.feed(text)
    return parser.seen


def hostile_scene() -> Scene:
    nodes = tuple(Node(name, index - 1 if index else None, name, np.eye(4)) for index, name in enumerate(HOSTILE))
    joints = tuple(SceneJoint(name, "revolute", 0.1) for name in HOSTILE)
    return Scene(HOSTILE[0], nodes, joints, HOSTILE[0], "ab" * 32, tuple(HOSTILE))


def test_same_input_same_bytes(small: Robot) -> None:
    assert page(robot_scene(small)) == page(robot_scene(small))
    assert page(robot_scene(small)) != page(robot_scene(small, {"lift": 0.1}))


def test_same_bytes_in_another_process() -> None:
    program = (
        "import hashlib; from nao_kin.robot.robot import load; from nao_kin.view.page import page;"
        "from nao_kin.view.robot_scene import robot_scene;"
        "print(hashlib.sha256(page(robot_scene(load('jaco2'))).encode()).hexdigest())"
    )
    there = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout.strip()
    assert there == hashlib.sha256(page(robot_scene(load("jaco2"))).encode()).hexdigest()


def test_hostile_names_bring_no_element_and_no_attribute() -> None:
    harmless = [re.sub(r"\W", "x", name) for name in HOSTILE]
    scene = hostile_scene()
    mild = Scene(
        harmless[0],
        scene.nodes,
        tuple(SceneJoint(name, "revolute", 0.1) for name in harmless),
        harmless[0],
        scene.sha256,
        tuple(harmless),
    )
    shapes = [[(tag, sorted(attributes)) for tag, attributes in tags(page(each))] for each in (scene, mild)]
    assert shapes[0] == shapes[1]
    for name in HOSTILE:
        assert html.escape(name) in page(scene)


def test_node_names_are_our_own() -> None:
    scene = hostile_scene()
    for path in node_paths(scene):
        assert re.fullmatch(r"/robot(/n\d+)+", path)
    for command in recorded(scene):
        for name in HOSTILE:
            assert name.encode() not in command
        assert re.fullmatch(r"[\w/<>]+", umsgpack.unpackb(command)["path"])


def test_nodes_are_nested_as_the_links_are(small: Robot) -> None:
    scene = robot_scene(small)
    paths = dict(zip((node.label for node in scene.nodes), node_paths(scene), strict=True))
    for joint in small.document.joints:
        assert paths[joint.child].startswith(paths[joint.parent] + "/")


def scripts(text: str) -> list[tuple[str, str]]:
    return re.findall(r"<script([^>]*)>(.*?)</script>", text, flags=re.DOTALL)


def test_the_policy_allows_exactly_the_scripts_of_the_page(small: Robot) -> None:
    text = page(robot_scene(small))
    policy = next(a["content"] for tag, a in tags(text) if a.get("http-equiv") == "Content-Security-Policy")
    assert policy is not None
    directives = dict(part.strip().split(" ", 1) for part in policy.split(";"))
    data, *programs = scripts(text)
    assert 'type="application/json"' in data[0]
    hashes = {f"'sha256-{base64.b64encode(hashlib.sha256(s.encode()).digest()).decode()}'" for _, s in programs}
    assert set(directives.pop("script-src").split()) == hashes
    assert directives == {
        "default-src": "'none'",
        "style-src": "'unsafe-inline'",
        "img-src": "data: blob:",
        "base-uri": "'none'",
        "form-action": "'none'",
    }


def test_nothing_outside_is_referred_to(small: Robot) -> None:
    for tag, attributes in tags(page(robot_scene(small))):
        assert tag not in {"link", "iframe", "object", "embed", "base"}
        assert not {"src", "href", "srcset", "action"} & set(attributes)


def test_the_data_is_json_without_a_tag(small: Robot) -> None:
    (_, data), *_ = scripts(page(robot_scene(small)))
    assert "<" not in data
    packed = json.loads(data)
    stream = io.BytesIO(zlib.decompress(base64.b64decode(packed["deflated"])))
    first, *lengths = packed["lengths"]
    assert json.loads(stream.read(first))["title"] == "small"
    commands = [umsgpack.unpackb(stream.read(length)) for length in lengths]
    assert not stream.read()
    assert sum(command["type"] == "set_transform" for command in commands) == len(small.frame_names)
    assert not any(command["type"] == "set_control" for command in commands)  # the viewer evaluates its callback


def test_values_are_printed_in_their_units(small: Robot) -> None:
    text = page(robot_scene(small, {"shoulder": -0.5, "lift": 0.0125}))
    assert "<td>−0.5000</td><td>−28.65°</td>" in text
    assert "<td>0.0125 m</td><td>12.5 mm</td>" in text
    assert "<td>0.0000</td><td>0.00°</td>" in page(robot_scene(small, {"roll": -1e-9}))


def test_source_and_hash_are_stated_without_a_directory(small: Robot, tmp_path: object) -> None:
    text = page(robot_scene(small))
    assert "small.urdf" in text
    assert small.document.sha256 in text
    assert str(tmp_path) not in text


def test_importing_the_view_starts_nothing_heavy() -> None:
    program = (
        "import sys, nao_kin.view.export;"
        "print([name for name in ('meshcat', 'trimesh', 'zmq', 'collada') if name in sys.modules])"
    )
    shown = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout.strip()
    assert shown == "[]"
