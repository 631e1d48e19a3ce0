"""Small robots of every version of the format, as it is used and as it is misused, by a seeded generator."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final, TypeVar

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np

__all__ = ["versioned_robot"]

T = TypeVar("T")

VERSIONS: Final = (
    None,
    None,
    "1.0",
    "1.0",
    "1.1",
    "1.1",
    "1.1",
    "1.2",
    "1.2",
    "1.2",
    "01.1",
    " 1.2",
    "1.3",
    "2.0",
    "1",
)
KINDS: Final = ("revolute", "revolute", "revolute", "continuous", "prismatic", "fixed")
SPOILT: Final = 0.02
"""How often a number is one that its version refuses; a file has about thirty."""


def versioned_robot(rng: np.random.Generator) -> bytes:
    """A tree of one to six joints in some version, with words of that version and of later ones."""
    version, joints = pick(VERSIONS, rng), int(rng.integers(1, 7))
    declared = "" if version is None else f' version="{version}"'
    links = [f"l{number}" for number in range(joints + 1)]
    parts = [f'<robot name="versioned"{declared}>']
    parts += [f'  <link name="{name}">{_inertial(rng)}{_solid(rng)}</link>' for name in links]
    for number in range(1, joints + 1):
        parent = links[int(rng.integers(number))]
        kind = pick(KINDS, rng)
        limit = _limit(rng) if kind in {"revolute", "prismatic"} or rng.random() < 0.3 else ""
        parts.append(
            f'  <joint name="j{number}" type="{kind}"><parent link="{parent}"/><child link="{links[number]}"/>'
            f"{_origin(rng)}{_axis(rng)}{limit}</joint>"
        )
    return "\n".join([*parts, "</robot>\n"]).encode()


def _origin(rng: np.random.Generator) -> str:
    words = []
    if rng.random() < 0.8:
        words.append(f'xyz="{_numbers(rng.uniform(-1.0, 1.0, 3))}"')
    turned = rng.random()
    if turned < 0.35 or turned > 0.98:
        words.append(f'rpy="{_numbers(_angles(rng))}"')
    if turned > 0.55:
        words.append(f'quat_xyzw="{_quaternion(rng)}"')
    return f"<origin {' '.join(words)}/>" if rng.random() < 0.9 else ""


def _angles(rng: np.random.Generator) -> np.ndarray:
    angles = rng.uniform(-3.1, 3.1, 3)
    if rng.random() < 0.2:
        angles[1] = pick((1.5707963267948966, -1.5707963267948966), rng)
    return angles


def _quaternion(rng: np.random.Generator) -> str:
    if rng.random() < SPOILT:
        return pick(("0 0 1", "x 0 0 1", "", "0 0 0 1 0", "nan 0 0 1"), rng)
    if rng.random() < 0.2:  # a pitch of a quarter turn, where roll and yaw are one
        return pick(("0 0.7071067811865476 0 0.7071067811865476", "0.5 -0.5 0.5 0.5", "0.5 0.5 0.5 0.5"), rng)
    quaternion = rng.normal(size=4)
    if rng.random() < 0.7:
        quaternion /= (quaternion**2).sum() ** 0.5
    return _numbers(quaternion)


def _axis(rng: np.random.Generator) -> str:
    if rng.random() < 0.2:
        return ""
    return f'<axis xyz="{pick(("1 0 0", "0 1 0", "0 0 1", "0 0 -1", "0.6 0 0.8", "0.6 -0.8 0"), rng)}"/>'


def _limit(rng: np.random.Generator) -> str:
    ends = sorted(rng.uniform(-2.0, 2.0, 2).tolist(), reverse=bool(rng.random() < SPOILT))
    values = {"lower": ends[0], "upper": ends[1], "velocity": 2.0 * rng.random(), "effort": 50.0 * rng.random()}
    values |= {name: 9.0 * rng.random() for name in ("acceleration", "deceleration", "jerk") if rng.random() < 0.3}
    words = []
    for name, value in values.items():
        if rng.random() < 0.05 and name in {"lower", "upper", "velocity", "effort"}:
            continue
        spoilt = rng.random() < SPOILT and name not in {"lower", "upper"}
        words.append(f'{name}="{pick(("-1", "fast", "", "inf"), rng) if spoilt else repr(float(value))}"')
    return f"<limit {' '.join(words)}/>"


def _inertial(rng: np.random.Generator) -> str:
    if rng.random() < 0.3:
        return ""
    moments = rng.uniform(0.1, 0.2, 3)
    names = dict(zip(("ixx", "iyy", "izz"), moments.tolist(), strict=True))
    names |= dict(zip(("ixy", "ixz", "iyz"), rng.uniform(-0.02, 0.02, 3).tolist(), strict=True))
    words = " ".join(f'{name}="{value!r}"' for name, value in names.items())
    origin = f'<origin xyz="{_numbers(rng.uniform(-0.2, 0.2, 3))}" {_rotation(rng)}/>'
    return f'<inertial>{origin}<mass value="{rng.random()!r}"/><inertia {words}/></inertial>'


def _rotation(rng: np.random.Generator) -> str:
    """One that no version refuses: urdfdom drops an inertial or a shape that it cannot read, and says nothing."""
    if rng.random() < 0.5:
        return f'rpy="{_numbers(_angles(rng))}"'
    quaternion = rng.normal(size=4)
    return f'quat_xyzw="{_numbers(quaternion)}"'


def _solid(rng: np.random.Generator) -> str:
    if rng.random() < 0.5:
        return ""
    radius, length = rng.uniform(0.01, 0.2, 2).tolist()
    shape = pick(("capsule", "cylinder"), rng)
    tag = pick(("visual", "collision"), rng)
    geometry = f'<geometry><{shape} radius="{radius!r}" length="{length!r}"/></geometry>'
    return f'<{tag}><origin xyz="{_numbers(rng.uniform(-0.2, 0.2, 3))}" {_rotation(rng)}/>{geometry}</{tag}>'


def _numbers(values: np.ndarray) -> str:
    return " ".join(repr(float(value)) for value in values)


def pick(options: Sequence[T], rng: np.random.Generator) -> T:
    """One of the options."""
    return options[int(rng.integers(len(options)))]
