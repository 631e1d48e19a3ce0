"""The kinematics and inertias of a file written again, by us, for readers that are not hardened against strangers."""

from __future__ import annotations

import html
import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from nao_kin.urdf.elements import Inertial, Limit, Origin, UrdfJoint, UrdfLink

__all__ = ["UNLIMITED", "kinematic_xml"]

# urdfdom refuses a <limit> without velocity or effort and does not read "inf"; the largest finite number is the
# nearest thing to "no limit" that it takes.
UNLIMITED = sys.float_info.max
"""What is written as a velocity or effort limit [rad/s, m/s, N m or N] where there is none."""


def kinematic_xml(name: str, links: Iterable[UrdfLink], joints: Iterable[UrdfJoint]) -> str:
    """A URDF with links, inertials, joints, axes and limits.

    Shapes are left out because nothing here loads them from Pinocchio, and couplings because they are applied outside
    it. Numbers are written so that reading them gives the same floats.
    """
    lines = ['<?xml version="1.0" encoding="UTF-8"?>', f"<robot name={_quoted(name)}>"]
    for link in links:
        lines.extend(_link(link))
    for joint in joints:
        lines.extend(_joint(joint))
    lines.append("</robot>")
    return "\n".join(lines) + "\n"


def _link(link: UrdfLink) -> Iterator[str]:
    if link.inertial is None:
        yield f"  <link name={_quoted(link.name)}/>"
        return
    yield f"  <link name={_quoted(link.name)}>"
    yield from _inertial(link.inertial)
    yield "  </link>"


def _inertial(inertial: Inertial) -> Iterator[str]:
    names = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    inertia = " ".join(f'{name}="{value!r}"' for name, value in zip(names, inertial.inertia, strict=True))
    yield "    <inertial>"
    yield f"      {_origin(inertial.origin)}"
    yield f'      <mass value="{inertial.mass!r}"/>'
    yield f"      <inertia {inertia}/>"
    yield "    </inertial>"


def _joint(joint: UrdfJoint) -> Iterator[str]:
    yield f'  <joint name={_quoted(joint.name)} type="{joint.kind}">'
    yield f"    <parent link={_quoted(joint.parent)}/>"
    yield f"    <child link={_quoted(joint.child)}/>"
    yield f"    {_origin(joint.origin)}"
    if joint.kind != "fixed":
        yield f'    <axis xyz="{_numbers(joint.axis)}"/>'
        if joint.limit is not None:
            yield f"    {_limit(joint.limit)}"
    yield "  </joint>"


def _limit(limit: Limit) -> str:
    values = {
        "lower": limit.lower,
        "upper": limit.upper,
        "velocity": UNLIMITED if limit.velocity is None else limit.velocity,
        "effort": UNLIMITED if limit.effort is None else limit.effort,
    }
    attributes = " ".join(f'{name}="{value!r}"' for name, value in values.items() if value is not None)
    return f"<limit {attributes}/>"


def _origin(origin: Origin) -> str:
    return f'<origin xyz="{_numbers(origin.xyz)}" rpy="{_numbers(origin.rpy)}"/>'


def _numbers(values: Iterable[float]) -> str:
    return " ".join(map(repr, values))


def _quoted(name: str) -> str:
    """A name as an attribute's value; names hold no control characters, the reader has refused them."""
    return f'"{html.escape(name)}"'
