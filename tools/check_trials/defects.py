"""Single defects that people make, put into sound files: each with the code and the lines where it must be found."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, TypeAlias

from check_trials.tags import Tag, line_at, with_path

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

__all__ = ["KINDS", "TWIN_CODES", "Kind", "Seeded", "seeded"]

Maker: TypeAlias = "Callable[[Tag, list[Tag]], Seeded | str | None]"
"""From an element, and all of the file, to the file with a defect there; None where it is no place for it."""

DEGREES: Final = 57.29577951


@dataclass(frozen=True, slots=True)
class Seeded:
    """A file with one defect, and where it shows: the lines from one place of the new text to another."""

    text: str
    start: int
    end: int
    also: frozenset[int] = frozenset()

    @property
    def lines(self) -> frozenset[int]:
        """The lines on which a finding is right."""
        first, last = line_at(self.text, self.start), line_at(self.text, max(self.start, self.end - 1))
        return frozenset(range(first, last + 1)) | self.also


@dataclass(frozen=True, slots=True)
class Kind:
    """A kind of defect: the code that must be reported, the path of its element, and how it is made."""

    code: str
    path: str
    make: Maker


def seeded(kind: Kind, tag: Tag, tags: list[Tag]) -> Seeded | None:
    """The file with this defect at this element; None where it is no place for it."""
    made = kind.make(tag, tags)
    if not isinstance(made, str):
        return made
    if made == tag.text:
        return None
    return Seeded(made, tag.start, tag.end + len(made) - len(tag.text))


def put(**values: str) -> Maker:
    """Other values for attributes that are there."""
    return lambda tag, _: tag.with_values(**values) if all(name in tag.attributes for name in values) else None


def drop(attribute: str) -> Maker:
    """An attribute left out."""
    pattern = rf"\s{attribute}\s*=\s*(\"[^\"]*\"|'[^']*')"
    return lambda tag, _: tag.replaced(re.sub(pattern, "", tag.tag)) if attribute in tag.attributes else None


def rename(old: str, new: str) -> Maker:
    """A word of the tag replaced; only elements without content, whose end tag needs no change."""
    return lambda tag, _: tag.replaced(tag.tag.replace(old, new, 1)) if tag.tag.endswith("/>") else None


def moving(make: Maker, *kinds: str) -> Maker:
    """Only in joints that move, or of these types."""
    return lambda tag, tags: make(tag, tags) if tag.kind in (kinds or ("revolute", "prismatic", "continuous")) else None


def without(child: str) -> Maker:
    """An element of the joint or link left out; it shows at the joint or link, or the part that held it."""

    def make(tag: Tag, tags: list[Tag]) -> Seeded | None:
        inner = [t for t in with_path(tags, f"{tag.path}/{child}") if tag.start < t.start < tag.stop]
        return Seeded(inner[0].removed(), tag.start, tag.end) if len(inner) == 1 else None

    return make


def scaled(attribute: str, factor: float, least: float) -> Maker:
    """All numbers times a factor, where the largest becomes at least so large."""

    def make(tag: Tag, _: list[Tag]) -> str | None:
        numbers = [number * factor for number in tag.numbers(attribute)]
        if not numbers or max(map(abs, numbers)) < least:
            return None
        return tag.with_values(**{attribute: " ".join(f"{number:.9g}" for number in numbers)})

    return make


def typo(attribute: str) -> Maker:
    """A name with two neighbouring letters swapped, so that it names nothing."""

    def make(tag: Tag, _: list[Tag]) -> str | None:
        name = tag.attributes.get(attribute, "")
        middle = len(name) // 2
        swapped = name[: middle - 1] + name[middle : middle + 1] + name[middle - 1 : middle] + name[middle + 1 :]
        known = len(name) < 4 or re.search(rf"[\"']{re.escape(swapped)}[\"']", tag.text)
        return None if known else tag.with_values(**{attribute: swapped})

    return make


def comma(tag: Tag, _: list[Tag]) -> str:
    """A decimal comma."""
    return tag.with_values(xyz=tag.attributes.get("xyz", "").replace(".", ",", 1))


def one_number_less(tag: Tag, _: list[Tag]) -> str:
    """Two numbers where three belong."""
    return tag.with_values(xyz=" ".join(tag.attributes.get("xyz", "").split()[:2]))


def inverted(tag: Tag, _: list[Tag]) -> str | None:
    """Lower and upper limit swapped."""
    lower, upper = tag.attributes.get("lower", "0"), tag.attributes.get("upper", "0")
    return tag.with_values(lower=upper, upper=lower) if float(lower) < float(upper) else None


def no_range(tag: Tag, _: list[Tag]) -> str:
    """The upper limit copied over the lower one."""
    return tag.with_values(upper=tag.attributes.get("lower", "0"))


def limits_in_degrees(tag: Tag, _: list[Tag]) -> str | None:
    """Limits in degrees, of a joint whose limits are angles and not a way to say "none"."""
    ends = [(tag.numbers(name) or [0.0])[0] * DEGREES for name in ("lower", "upper")]
    if not 13.0 < max(map(abs, ends)) < 1000.0:
        return None
    return tag.with_values(lower=f"{ends[0]:.4g}", upper=f"{ends[1]:.4g}")


def product_too_large(tag: Tag, _: list[Tag]) -> str | None:
    """A product of inertia that no body has."""
    largest = max(tag.numbers(name)[0] for name in ("ixx", "iyy", "izz"))
    return tag.with_values(ixy=f"{3.0 * largest:.9g}") if largest > 1e-9 else None


def moment_too_large(tag: Tag, _: list[Tag]) -> str | None:
    """A moment of inertia that is larger than the others together."""
    moments = [tag.numbers(name)[0] for name in ("ixx", "iyy", "izz")]
    return tag.with_values(izz=f"{3.0 * sum(moments):.9g}") if min(moments) > 1e-9 else None


def square_millimetres(tag: Tag, tags: list[Tag]) -> str | None:
    """An inertia in kg mm², of a link that weighs something and is not a stub."""
    masses = [t for t in with_path(tags, "link/inertial/mass") if t.owner is tag.owner]
    moments = {name: tag.numbers(name)[0] for name in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")}
    mass = masses[0].numbers("value")[0] if masses else 0.0
    if mass < 0.01 or max(moments.values()) / mass < 1e-4:  # a radius of gyration of less than a centimetre
        return None
    return tag.with_values(**{name: f"{1e6 * moment:.9g}" for name, moment in moments.items()})


def blanks(tag: Tag, _: list[Tag]) -> str:
    """Blanks around a single number."""
    return tag.with_values(value=f" {tag.attributes.get('value', '0')} ")


def mimic_itself(tag: Tag, _: list[Tag]) -> str | None:
    """A joint that follows itself."""
    return tag.with_values(joint=tag.name) if tag.kind != "fixed" else None


def copied(tag: Tag, _: list[Tag]) -> Seeded:
    """The element twice, as after a paste."""
    again = tag.text[tag.start : tag.stop]
    text = tag.text[: tag.stop] + again + tag.text[tag.stop :]
    return Seeded(text, tag.stop, tag.stop + tag.end - tag.start)


def second_parent(tag: Tag, _: list[Tag]) -> Seeded | None:
    """A second joint to the same child."""
    name = tag.name
    again = tag.text[tag.start : tag.stop].replace(f'"{name}"', f'"{name}_again"', 1)
    if name not in tag.tag or f'"{name}"' not in tag.tag:
        return None
    text = tag.text[: tag.stop] + again + tag.text[tag.stop :]
    return Seeded(text, tag.stop, tag.stop + tag.end - tag.start)


def forgotten(tag: Tag, tags: list[Tag]) -> Seeded | None:
    """A joint left out, so that its child becomes a second root; it shows at whichever root comes second."""
    children = [t for t in with_path(tags, "joint/child") if t.owner is tag]
    below = {t.attributes.get("link") for t in with_path(tags, "joint/child")}
    roots = [t for t in with_path(tags, "link") if t.attributes.get("name") not in below]
    links = [t for t in with_path(tags, "link") if children and t.name == children[0].attributes.get("link")]
    mimicked = any(t.attributes.get("joint") == tag.name for t in with_path(tags, "joint/mimic"))
    if len(roots) != 1 or len(links) != 1 or mimicked:
        return None
    second = max(links[0], roots[0], key=lambda t: t.start)
    shift = tag.stop - tag.start if second.start > tag.start else 0
    return Seeded(tag.removed(), second.start - shift, second.end - shift)


def looped(tag: Tag, tags: list[Tag]) -> Seeded | None:
    """A joint that hangs on a child of its own child; it shows at either joint of the loop."""
    own = {t.path: t for t in tags if t.owner is tag}
    child = own["joint/child"].attributes["link"] if "joint/child" in own else ""
    for parent in with_path(tags, "joint/parent"):
        if parent.attributes.get("link") == child and parent.owner is not None:
            grandchild = next((t for t in with_path(tags, "joint/child") if t.owner is parent.owner), None)
            if grandchild is not None and "joint/parent" in own:
                text = own["joint/parent"].with_values(link=grandchild.attributes["link"])
                shift = len(text) - len(tag.text) if parent.owner.start > own["joint/parent"].start else 0
                other = line_at(text, parent.owner.start + shift)
                return Seeded(text, tag.start, tag.end, frozenset({other}))
    return None


def joint_kinds() -> Iterator[Kind]:
    """Defects of joints."""
    origin, limit, axis = "joint/origin", "joint/limit", "joint/axis"
    yield Kind("not-a-number", origin, comma)
    yield Kind("wrong-count", origin, one_number_less)
    yield Kind("not-finite", origin, put(rpy="0 nan 0"))
    yield Kind("not-finite", limit, put(upper="inf"))
    yield Kind("out-of-range", origin, put(xyz="0 0 1e12"))
    yield Kind("length-in-millimetres", origin, scaled("xyz", 1000.0, 20.0))
    yield Kind("angle-in-degrees", origin, scaled("rpy", DEGREES, 7.0))
    yield Kind("unexpanded-xacro", origin, put(xyz="${length} 0 0"))
    yield Kind("misspelt-element", origin, rename("<origin", "<orgin"))
    yield Kind("misspelt-attribute", origin, rename("xyz=", "xzy="))
    yield Kind("repeated-element", origin, copied)
    yield Kind("zero-axis", axis, moving(put(xyz="0 0 0")))
    yield Kind("axis-not-unit", axis, moving(put(xyz="0 1 1")))
    yield Kind("misspelt-element", axis, rename("<axis", "<axes"))
    yield Kind("inverted-limit", limit, moving(inverted, "revolute", "prismatic"))
    yield Kind("zero-range", limit, moving(no_range, "revolute", "prismatic"))
    yield Kind("limit-in-degrees", limit, moving(limits_in_degrees, "revolute"))
    yield Kind("incomplete-limit", limit, drop("velocity"))
    yield Kind("incomplete-limit", limit, drop("effort"))
    yield Kind("negative-limit", limit, put(velocity="-1"))
    yield Kind("misspelt-attribute", limit, rename("velocity=", "velocty="))
    yield Kind("missing-limit", "joint", moving(without("limit"), "revolute", "prismatic"))
    yield Kind("unknown-joint-type", "joint", put(type="revolut"))
    yield Kind("no-joint-type", "joint", drop("type"))
    yield Kind("no-name", "joint", drop("name"))
    yield Kind("no-parent", "joint", without("parent"))
    yield Kind("no-child", "joint", without("child"))
    yield Kind("unknown-parent", "joint/parent", typo("link"))
    yield Kind("unknown-child", "joint/child", typo("link"))
    yield Kind("duplicate-joint", "joint", copied)
    yield Kind("two-parents", "joint", second_parent)
    yield Kind("several-roots", "joint", forgotten)
    yield Kind("cycle", "joint", looped)
    yield Kind("self-mimic", "joint/mimic", mimic_itself)
    yield Kind("unknown-leader", "joint/mimic", moving(typo("joint")))
    yield Kind("zero-multiplier", "joint/mimic", moving(put(multiplier="0")))


def link_kinds() -> Iterator[Kind]:
    """Defects of links."""
    mass, inertia = "link/inertial/mass", "link/inertial/inertia"
    yield Kind("not-a-number", mass, put(value="heavy"))
    yield Kind("missing-number", mass, drop("value"))
    yield Kind("negative-mass", mass, put(value="-1.5"))
    yield Kind("stray-blank", mass, blanks)
    yield Kind("missing-number", inertia, drop("iyy"))
    yield Kind("inertia-not-positive", inertia, product_too_large)
    yield Kind("triangle-inequality", inertia, moment_too_large)
    yield Kind("inertia-out-of-scale", inertia, square_millimetres)
    yield Kind("misspelt-element", inertia, rename("<inertia", "<inerta"))
    yield Kind("incomplete-inertial", "link/inertial", without("mass"))
    yield Kind("negative-size", "link/collision/geometry/cylinder", put(radius="-0.1"))
    yield Kind("wrong-count", "link/collision/geometry/box", put(size="0.1"))
    yield Kind("mesh-without-name", "link/visual/geometry/mesh", drop("filename"))
    yield Kind("mesh-missing", "link/visual/geometry/mesh", lambda tag, _: _lost_mesh(tag))
    yield Kind("mesh-absolute", "link/visual/geometry/mesh", put(filename="file:///home/someone/part.stl"))
    yield Kind("mesh-unit", "link/collision/geometry/mesh", put(scale="1000 1000 1000"))
    yield Kind("duplicate-link", "link", copied)
    yield Kind("undefined-material", "link/visual/material", lambda tag, tags: _lost_material(tag, tags))


def _lost_material(tag: Tag, tags: list[Tag]) -> Seeded | str | None:
    """A material that is only named here, by a name that is none."""
    return typo("name")(tag, tags) if tag.tag.endswith("/>") else None


def _lost_mesh(tag: Tag) -> str | None:
    name = tag.attributes.get("filename", "")
    return tag.with_values(filename=re.sub(r"(\w)(\.\w+)$", r"\1_\2", name)) if name.startswith("package://") else None


def twin_kinds() -> Iterator[Kind]:
    """Defects on one side of a robot whose joints are called L… and R…."""
    yield Kind("mirror-origin", "joint/origin", _on_one_side(lambda tag: _shifted(tag, 1)))
    yield Kind("mirror-axis", "joint/axis", _on_one_side(lambda tag: tag.with_values(xyz="0.6 0 0.8")))
    yield Kind("swapped-digits", "joint/limit", _on_one_side(_digits_swapped))
    yield Kind("mirror-velocity", "joint/limit", _on_one_side(lambda tag: _times(tag, "velocity", 1.3)))
    yield Kind("mirror-effort", "joint/limit", _on_one_side(lambda tag: _times(tag, "effort", 0.7)))
    yield Kind("mirror-limit", "joint/limit", _on_one_side(lambda tag: _times(tag, "upper", 0.9)))
    yield Kind("mirror-mass", "link/inertial/mass", _on_one_side(lambda tag: _times(tag, "value", 1.5)))


def _on_one_side(change: Callable[[Tag], str | None]) -> Maker:
    def make(tag: Tag, tags: list[Tag]) -> Seeded | None:
        side = {"L": "R", "R": "L"}.get(tag.name[:1], "")
        twins = [t for t in with_path(tags, tag.path) if t.name == side + tag.name[1:]]
        text = change(tag) if len(twins) == 1 and tag.kind != "fixed" else None
        if text is None or text == tag.text:
            return None
        # Nobody can tell which of two twins is the wrong one, so the finding may stand at either.
        shift = len(text) - len(tag.text) if twins[0].start > tag.start else 0
        return Seeded(text, tag.start, tag.end, frozenset({line_at(text, twins[0].start + shift)}))

    return make


def _shifted(tag: Tag, axis: int) -> str | None:
    xyz = tag.numbers("xyz")
    if len(xyz) != 3 or xyz[axis] == 0.0:
        return None
    xyz[axis] = -xyz[axis]
    return tag.with_values(xyz=" ".join(f"{x:.9g}" for x in xyz))


def _digits_swapped(tag: Tag) -> str | None:
    upper = tag.attributes.get("upper", "")
    found = re.search(r"\.\d*?([1-9])(?!\1)([1-9])", upper)
    if found is None:
        return None
    a = found.start(1)
    return tag.with_values(upper=upper[:a] + upper[a + 1] + upper[a] + upper[a + 2 :])


def _times(tag: Tag, attribute: str, factor: float) -> str | None:
    numbers = tag.numbers(attribute)
    return tag.with_values(**{attribute: f"{numbers[0] * factor:.9g}"}) if numbers and abs(numbers[0]) > 1e-3 else None


TWIN_CODES: Final = frozenset(kind.code for kind in twin_kinds())
"""Codes of the defects on one side."""

KINDS: Final = (*joint_kinds(), *link_kinds(), *twin_kinds())
"""Every kind of defect."""
