"""Each structural rule: what it refuses, on which line, and the near miss that it lets pass."""

from __future__ import annotations

import pytest
from lxml import etree

from nao_kin.errors import UrdfError
from nao_kin.urdf import LIMITS, parse_urdf
from nao_kin.urdf.structure import STAGES, Outline, defects

LIMIT = '<limit lower="-1" upper="1" velocity="1" effort="1"/>'


def two_links(inside: str = LIMIT, kind: str = "revolute") -> str:
    """A file of one joint whose content starts on line 7."""
    return (
        '<robot name="r">\n<link name="a"/>\n<link name="b"/>\n'
        f'<joint name="j" type="{kind}">\n<parent link="a"/>\n<child link="b"/>\n{inside}\n</joint>\n</robot>'
    )


def newer(inside: str, version: str = "1.1", kind: str = "revolute") -> str:
    """The same in a later version of the format."""
    return two_links(inside, kind).replace('name="r"', f'name="r" version="{version}"')


def one_link(inside: str) -> str:
    """A file of one link whose content starts on line 3."""
    return f'<robot name="r">\n<link name="a">\n{inside}\n</link>\n</robot>'


def tree(*edges: str, kind: str = "fixed", links: str = "abcdef") -> str:
    """A file of the first links, one a line from line 2, and joints such as "ab" from a to b, one a line after them."""
    names = sorted({*"".join(edges)} & {*links})
    parts = [f'<link name="{name}"/>' for name in names]
    for number, (parent, child) in enumerate(edges):
        parts.append(
            f'<joint name="j{number}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>{LIMIT}</joint>'
        )
    return "\n".join(['<robot name="r">', *parts, "</robot>"])


def mimics(*followers: str) -> str:
    """A file of moving joints j0, j1, … one a line from line 2, each with the given content."""
    parts = ['<robot name="r"><link name="l"/>']
    for number, inside in enumerate(followers):
        ends = f'<parent link="l"/><child link="l{number}"/>'
        parts.append(f'<link name="l{number}"/><joint name="j{number}" type="revolute">{ends}{LIMIT}{inside}</joint>')
    return "\n".join([*parts, "</robot>"])


def visual(shape: str) -> str:
    return one_link(f"<visual><geometry>\n{shape}</geometry></visual>")


def solid_numbers(inside: str) -> str:
    return one_link(f"<inertial>\n{inside}</inertial>")


INERTIA = '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'
XACRO = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'

REFUSED: dict[str, tuple[str, str, int, str]] = {
    # name: (code, text, line, part of the message)
    "SDF": ("not-robot", '\n<sdf version="1.6"/>', 2, "<sdf>.*Gazebo"),
    "MJCF": ("not-robot", "<mujoco/>", 1, "<mujoco>.*MuJoCo"),
    "HTML": ("not-robot", "<html/>", 1, "<html>"),
    "prefixed robot": ("not-robot", '<x:robot xmlns:x="urn:x" name="r"/>', 1, "begins with <robot>"),
    "xacro macro": (
        "unexpanded-xacro",
        f'<robot {XACRO}>\n<xacro:include filename="x"/></robot>',
        2,
        "<xacro:include>.*xacro file.xacro > file.urdf",
    ),
    "xacro by another prefix": (
        "unexpanded-xacro",
        f"<robot {XACRO.replace(':xacro', ':x')}>\n<x:if/></robot>",
        2,
        "if",
    ),
    "xacro without namespace": ("", "<robot>\n<xacro:if/></robot>", 2, "unexpanded xacro"),
    "xacro in a joint": ("unexpanded-xacro", two_links(f"<xacro:origin {XACRO}/>" + LIMIT), 7, "xacro:origin"),
    "macro that a link is missing from": (
        "unexpanded-xacro",
        two_links().replace('<robot name="r">', f'<robot name="r" {XACRO}>\n<xacro:arm/>').replace('"a"', '"x"', 1),
        2,
        "xacro:arm",
    ),
    "version of the future": ("urdf-version", '<robot name="r" version="1.3"><link name="a"/></robot>', 1, "'1.3'"),
    "version of one number": ("urdf-version", '<robot name="r" version="1"><link name="a"/></robot>', 1, "'1'"),
    "xacro value": ("unexpanded-xacro", one_link('<visual name="${x}"/>'), 3, r"\$\{x\}"),
    "xacro argument": ("unexpanded-xacro", visual('<mesh filename="$(find p)/x.stl"/>'), 4, "find p"),
    "xacro robot name": ("unexpanded-xacro", '<robot name="$(arg name)"><link name="a"/></robot>', 1, "arg name"),
    "no robot name": ("no-name", '\n<robot><link name="a"/></robot>', 2, "robot has no name"),
    "empty robot name": ("no-name", '<robot name=""><link name="a"/></robot>', 1, "no name"),
    "no link name": ("no-name", '<robot name="r">\n<link/></robot>', 2, "link has no name"),
    "blank link name": ("no-name", '<robot name="r">\n<link name=" "/></robot>', 2, "link has no name"),
    "no joint name": ("no-name", two_links().replace(' name="j"', ""), 4, "joint has no name"),
    "control character": ("bad-name", '<robot name="r">\n<link name="a&#10;b"/></robot>', 2, r"'a\\nb'"),
    "terminal escape": ("bad-name", '<robot name="r">\n<link name="a&#x9b;2J"/></robot>', 2, "control"),
    "writing direction": ("bad-name", '<robot name="r">\n<link name="a&#x202e;b"/></robot>', 2, "invisible"),
    "name of 257": ("bad-name", f'<robot name="r">\n<link name="{"x" * 257}"/></robot>', 2, "257 characters"),
    "material name of 257": ("bad-name", one_link(f'<visual><material name="{"x" * 257}"/></visual>'), 3, "257"),
    "two links of one name": (
        "duplicate-link",
        '<robot name="r">\n<link name="a"/>\n<link name="a"/></robot>',
        3,
        "line 2",
    ),
    "two joints of one name": ("duplicate-joint", tree("ab", "ac").replace("j1", "j0"), 6, "line 5"),
    "world": ("reserved-name", two_links().replace('"b"', '"universe"'), 3, "reserved"),
    "world joint": ("reserved-name", two_links().replace('"j"', '"universe"'), 4, "reserved"),
    "no type": ("no-joint-type", two_links().replace(' type="revolute"', ""), 4, "no type"),
    "unknown type": ("unknown-joint-type", two_links(kind="revolut"), 4, "'revolut'.*mean 'revolute'"),
    "spherical": ("unknown-joint-type", two_links(kind="ball"), 4, "'ball'.*Types"),
    "floating": ("unsupported-joint", two_links(kind="floating"), 4, "is floating; only joints with one number"),
    "planar": ("unsupported-joint", two_links(kind="planar"), 4, "is planar; only joints with one number"),
    "two parents elements": ("repeated-end", two_links('<parent link="b"/>' + LIMIT), 7, "2 <parent>"),
    "no parent": ("no-parent", two_links().replace('<parent link="a"/>', ""), 4, "no <parent>"),
    "no child": ("no-child", two_links().replace('<child link="b"/>', ""), 4, "no <child>"),
    "parent without link": (
        "no-parent",
        two_links().replace('<parent link="a"/>', "<parent/>"),
        5,
        "names no link",
    ),
    "unknown parent": (
        "unknown-parent",
        two_links().replace('"a"', '"torso"').replace('<parent link="torso"', '<parent link="Torzo"'),
        5,
        "'Torzo'.*mean 'torso'",
    ),
    "unknown child": ("unknown-child", two_links().replace('child link="b"', 'child link="zzz"'), 6, "'zzz'"),
    "own parent": ("self-joint", two_links().replace('child link="b"', 'child link="a"'), 4, "with itself"),
    "two numbers": ("wrong-count", two_links('<origin xyz="1 2"/>' + LIMIT), 7, "xyz .* 2 numbers instead of 3"),
    "four numbers": ("wrong-count", two_links('<origin rpy="1 2 3 4"/>' + LIMIT), 7, "rpy .* 4 numbers instead of 3"),
    "no number": ("wrong-count", two_links('<origin xyz=""/>' + LIMIT), 7, "no number instead of 3"),
    "commas": ("not-a-number", two_links('<origin xyz="1, 2, 3"/>' + LIMIT), 7, "without commas"),
    "NaN": ("not-finite", two_links('<origin xyz="0 nan 0"/>' + LIMIT), 7, "'nan'"),
    "infinity": ("not-finite", two_links('<origin xyz="0 0 -inf"/>' + LIMIT), 7, "'-inf'"),
    "1e999": ("not-finite", two_links('<origin xyz="0 0 1e999"/>' + LIMIT), 7, "'1e999'.*largest"),
    "far away": ("out-of-range", two_links('<origin xyz="0 0 -2e9"/>' + LIMIT), 7, r"beyond ±1e\+09"),
    "hexadecimal": ("not-a-number", two_links('<axis xyz="0x1 0 0"/>' + LIMIT), 7, "'0x1'"),
    "underscore": ("not-a-number", two_links('<axis xyz="1_0 0 0"/>' + LIMIT), 7, "'1_0'"),
    "other digits": ("not-a-number", two_links('<axis xyz="١ 0 0"/>' + LIMIT), 7, "not a finite decimal"),
    "other blanks": ("wrong-count", two_links('<axis xyz="1\u20030\u20030"/>' + LIMIT), 7, "1 number instead of 3"),
    "limit word": ("not-a-number", two_links(LIMIT.replace('"-1"', '"low"')), 7, "lower .* 'low'"),
    "negative velocity": ("negative-limit", two_links(LIMIT.replace('velocity="1"', 'velocity="-1"')), 7, "below 0"),
    "negative effort": ("negative-limit", two_links(LIMIT.replace('effort="1"', 'effort="-1"')), 7, "below 0"),
    "mimic factor": ("not-a-number", two_links(LIMIT + '<mimic joint="k" multiplier="x"/>'), 7, "multiplier"),
    "negative mass": ("negative-mass", solid_numbers(f'<mass value="-1"/>{INERTIA}'), 4, "below 0"),
    "no mass value": ("missing-number", solid_numbers(f"<mass/>{INERTIA}"), 4, "value .* is missing"),
    "no ixy": (
        "missing-number",
        solid_numbers('<mass value="1"/>' + INERTIA.replace('ixy="0"', "")),
        4,
        "ixy .* missing",
    ),
    "infinite inertia": ("not-finite", solid_numbers(INERTIA.replace('izz="1"', 'izz="inf"')), 4, "izz"),
    "negative box": ("negative-size", visual('<box size="1 -1 1"/>'), 4, "size .* below 0"),
    "negative radius": ("negative-size", visual('<sphere radius="-0.1"/>'), 4, "radius .* below 0"),
    "no length": ("missing-number", visual('<cylinder radius="1"/>'), 4, "length .* missing"),
    "colour of three": (
        "wrong-count",
        '<robot name="r">\n<material><color rgba="1 1 1"/></material></robot>',
        2,
        "rgba",
    ),
    "mesh scale": ("wrong-count", visual('<mesh filename="x.stl" scale="1"/>'), 4, "scale"),
    "mesh without file": ("mesh-without-name", visual("<mesh/>"), 4, "no filename"),
    "zero axis": ("zero-axis", two_links('<axis xyz="0 0 0"/>' + LIMIT), 7, "no length.*0 0 1"),
    "almost zero axis": ("zero-axis", two_links('<axis xyz="0 9e-13 0"/>' + LIMIT), 7, "no length"),
    "revolute without limit": ("missing-limit", two_links(""), 4, "no <limit>.*continuous"),
    "prismatic without limit": ("missing-limit", two_links("", "prismatic"), 4, "no <limit>"),
    "inverted limits, 1.2": ("inverted-limit", newer('<limit lower="1" upper="-1"/>', "1.2"), 7, "above.*swapped"),
    "inverted and fixed, 1.2": ("inverted-limit", newer('<limit lower="1" upper="-1"/>', "1.2", "fixed"), 7, "above"),
    "no upper limit, 1.2": ("incomplete-limit", newer('<limit lower="-0.5"/>', "1.2"), 7, "no upper.*1.2 .* demands"),
    "negative acceleration, 1.2": (
        "negative-limit",
        newer(LIMIT.replace("/>", ' acceleration="-1"/>'), "1.2"),
        7,
        "acceleration .* below 0",
    ),
    "jerk in words, 1.2": ("not-a-number", newer(LIMIT.replace("/>", ' jerk="much"/>'), "1.2", "fixed"), 7, "jerk"),
    "two rotations": ("two-rotations", newer('<origin rpy="0 0 1" quat_xyzw="0 0 0 1"/>' + LIMIT), 7, "twice"),
    "no quaternion": ("zero-quaternion", newer('<origin quat_xyzw="0 0 0 0"/>' + LIMIT), 7, "no length.*0 0 0 1"),
    "three of a quaternion": ("wrong-count", newer('<origin quat_xyzw="0 0 1"/>' + LIMIT), 7, "3 numbers instead of 4"),
    "capsule without length": (
        "missing-number",
        visual('<capsule radius="1"/>').replace('name="r"', 'name="r" version="1.1"'),
        4,
        "length .* missing",
    ),
    "mimic without joint": ("unknown-leader", mimics("", "<mimic/>"), 3, "names no joint"),
    "mimic unknown": ("unknown-leader", mimics("", '<mimic joint="J0x"/>'), 3, "'J0x'.*mean 'j0'"),
    "mimic itself": ("self-mimic", mimics("", '<mimic joint="j1"/>'), 3, "mimics itself"),
    "mimic fixed": (
        "fixed-leader",
        mimics("", '<mimic joint="j0"/>').replace('"revolute"', '"fixed"', 1),
        3,
        "does not move",
    ),
    "no links": ("no-links", '<robot name="r"/>', 1, "no links"),
    "link with two parents": ("two-parents", tree("ac", "bc", "ab"), 6, "child of the joint 'j0' already"),
    "two roots": ("several-roots", tree("ab", "cd"), 4, "'c' hangs on no joint.*'a'"),
    "lonely link": ("several-roots", '<robot name="r">\n<link name="a"/>\n<link name="b"/></robot>', 3, "no joint"),
    "cycle": ("cycle", tree("ab", "bc", "ca"), 5, "closed loop"),
    "cycle beside a tree": ("cycle", tree("ab", "cd", "dc"), 7, "'c'|'d'"),
    "cycle with a tail": ("cycle", tree("ab", "cd", "dc", "de"), 8, "closed loop"),
    "mimic pair": ("mimic-cycle", mimics('<mimic joint="j1"/>', '<mimic joint="j0"/>'), 2, "circle"),
    "mimic ring with a tail": (
        "mimic-cycle",
        mimics("", '<mimic joint="j2"/>', '<mimic joint="j3"/>', '<mimic joint="j2"/>'),
        4,
        "'j2', 'j3'",
    ),
    "1001 links": ("too-many", '<robot name="r">\n' + '<link name="a"/>\n' * 1001 + "</robot>", 1002, "at most 1000"),
    "1001 joints": ("too-many", '<robot name="r">\n' + '<joint name="a"/>\n' * 1001 + "</robot>", 1002, "at most 1000"),
    "151 moving joints": ("too-many", mimics(*[""] * 151), 152, "151 moving joints; at most 150"),
}


@pytest.mark.parametrize(("code", "text", "line", "reason"), REFUSED.values(), ids=REFUSED)
def test_defect_is_refused_with_its_line(code: str, text: str, line: int, reason: str) -> None:
    with pytest.raises(UrdfError, match=reason) as caught:
        parse_urdf(text.encode(), "robot.urdf")
    assert caught.value.line == line
    assert str(caught.value).startswith(f"robot.urdf:{line}: ")
    assert str(caught.value).isprintable()
    if code:
        found = [defect.code for defect in defects(etree.fromstring(text.encode()))]
        assert found[0] == code, f"found {found}"


def test_every_rule_is_tried() -> None:
    trees = [etree.fromstring(text.encode()) for code, text, *_ in REFUSED.values() if code]
    for rule in (rule for stage in STAGES for rule in stage):
        assert any(next(rule(Outline(tree)), None) is not None for tree in trees), rule.__name__


def chain(count: int) -> str:
    """A chain of so many links with fixed joints."""
    links = "".join(f'<link name="l{i}"/>' for i in range(count))
    joint = '<joint name="j{0}" type="fixed"><parent link="l{0}"/><child link="l{1}"/></joint>'
    return f'<robot name="r">{links}{"".join(joint.format(i, i + 1) for i in range(count - 1))}</robot>'


PASSED = {
    "1000 links in one chain": chain(LIMITS.links),
    "150 moving joints": mimics(*[""] * LIMITS.moving_joints),
    "name of 256": f'<robot name="r"><link name="{"x" * 256}"/></robot>',
    "link and joint of one name": two_links().replace('"j"', '"b"'),
    "robot and link of one name": '<robot name="a"><link name="a"/></robot>',
    "world as the root": two_links().replace('"a"', '"universe"'),
    "names of other scripts": two_links().replace('"b"', '"右 肘 é"'),
    "limits equal": two_links('<limit lower="1" upper="1" velocity="0" effort="0"/>'),
    "limits absent": two_links("<limit/>"),
    "continuous without limit": two_links("", "continuous"),
    "continuous with inverted limits": two_links('<limit lower="1" upper="-1"/>', "continuous"),
    "fixed with zero axis": two_links('<axis xyz="0 0 0"/>', "fixed"),
    "fixed that mimics": two_links('<mimic joint="nobody"/>', "fixed"),
    "shortest axis": two_links('<axis xyz="0 0 1e-12"/>' + LIMIT),
    "longest axis": two_links('<axis xyz="1e308 1e308 -1e308"/>' + LIMIT),
    "all ways to write a number": two_links('<origin xyz="+1. .5 -1E-3" rpy="  0\t0\n0 "/>' + LIMIT),
    "smallest numbers": two_links('<origin xyz="1e-999 0 -0"/>' + LIMIT),
    "massless": solid_numbers(f'<mass value="0"/>{INERTIA}'),
    "half an inertial": solid_numbers('<mass value="1"/>'),
    "flat box": visual('<box size="0 1 1"/>'),
    "mirrored mesh": visual('<mesh filename="x.stl" scale="-1 1 1"/>'),
    "capsule before 1.1": visual('<capsule radius="x"/>'),
    "quaternion before 1.1": two_links('<origin rpy="0 0 1" quat_xyzw="x"/>' + LIMIT),
    "acceleration before 1.2": newer(LIMIT.replace("/>", ' acceleration="-x"/>')),
    "limits without speed, 1.2": newer('<limit lower="-1" upper="1"/>', "1.2"),
    "endless without limits, 1.2": newer("<limit/>", "1.2", "continuous"),
    "swapped limits, told at loading": two_links('<limit lower="1" upper="-1"/>'),
    "half a swapped limit": newer('<limit lower="0.5"/>'),
    "axis without direction": two_links("<axis/>" + LIMIT),
    "fixed axis without direction": two_links("<axis/>", "fixed"),
    "prefix of a simulator": two_links(LIMIT).replace("</robot>", "<gazebo><sensor:camera x:y='1'/></gazebo></robot>"),
    "macro beside a whole robot": two_links(LIMIT).replace("</robot>", "<xacro:gripper a='${b}'/></robot>"),
    "chain of followers": mimics("", '<mimic joint="j0"/>', '<mimic joint="j1" multiplier="-2"/>'),
    "follower before its leader": mimics('<mimic joint="j1"/>', ""),
    "other programs": '<robot name="r"><link name="a"/><gazebo><origin xyz="x"/><x y="$(arg z)"/></gazebo></robot>',
    "link of another program": '<robot name="r"><link name="a"/><gazebo><link/><joint/></gazebo></robot>',
    "other namespaces": '<robot name="r" xmlns:x="urn:x"><link name="a"/><x:link/><x:joint/></robot>',
    "xacro declared only": f'<robot name="r" {XACRO}><link name="a"/></robot>',
    "link inside a link": one_link('<link name="a"/>'),
    "price": one_link('<visual name="$5 {x}"/>'),
}


@pytest.mark.parametrize("text", PASSED.values(), ids=PASSED)
def test_near_miss_passes(text: str) -> None:
    document = parse_urdf(text.encode())
    assert parse_urdf(document.to_xml().encode()).root == document.root


def test_first_defect_of_the_file_is_reported() -> None:
    text = newer('<limit lower="2" upper="1"/>\n<axis xyz="0 0 0"/>', "1.2").replace('link="b"', 'link="c"')
    assert [defect.line for defect in defects(etree.fromstring(text.encode()))] == [6, 8, 7]
    with pytest.raises(UrdfError, match="'c'") as caught:
        parse_urdf(text.encode())
    assert caught.value.line == 6


def test_misspelt_link_is_not_reported_as_a_second_root() -> None:
    found = list(defects(etree.fromstring(two_links().replace('child link="b"', 'child link="B"').encode())))
    assert [defect.code for defect in found] == ["unknown-child"]
    assert found[0].hint == "Did you mean 'b'?"


def test_many_defects_cost_no_more_than_one() -> None:
    joint = '<joint name="{0}{1}" type="fixed"><parent link="x{1}{0}"/><child link="y{1}{0}"/></joint>\n'
    long = "ab" * 28
    text = "".join(joint.format(i, long) for i in range(999)) + "".join(
        f'<link name="{i}{long}"/>' for i in range(1000)
    )
    with pytest.raises(UrdfError, match="is not a link") as caught:
        parse_urdf(f'<robot name="r">\n{text}</robot>'.encode())
    assert caught.value.line == 2
