"""Which numbers of a robot may be off: chosen by a word, by joint, or one by one, and how they read."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

from nao_kin.calibration.chain_model import MOTIONS, nominal, placed_by
from nao_kin.errors import InvalidInputError, UnknownNameError

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from nao_kin.calibration.chain_model import Model, NumberName

__all__ = ["CHOICES", "chosen", "every_name", "key_of", "nominal_values", "phrase", "unit_of"]

CHOICES: Final = {
    "offsets": "the zero of every joint",
    "ratios": "the zero and the ratio of every joint, which has its sign",
    "geometry": "four numbers of every joint's line in its link (two shifts, two tilts), and the tool's six",
}
"""Words for sets of numbers."""

_LINE: Final = ("x", "y", "rx", "ry")


def every_name(models: Iterable[Model]) -> tuple[NumberName, ...]:
    """Every number of several chains from one base, each once."""
    return tuple(dict.fromkeys(name for model in models for name in model.names))


def nominal_values(models: Iterable[Model]) -> dict[NumberName, float]:
    """The numbers of the nominal robot."""
    return {name: nominal(name) for name in every_name(models)}


def key_of(name: NumberName) -> str:
    """A number in one word: ``"elbow.zero"``, ``"tool.x"``."""
    return ".".join(name)


def unit_of(name: NumberName, slides: Mapping[str, bool]) -> str:
    """``"m"``, ``"rad"`` or ``""``."""
    owner, number = name
    if number == "ratio":
        return ""
    if number == "zero":
        return "m" if slides.get(owner, False) else "rad"
    return "rad" if number.startswith("r") else "m"


def phrase(name: NumberName) -> str:
    """A number as a person would call it."""
    owner, number = name
    if number in ("zero", "ratio"):
        return f"the {number} of {owner}"
    where = owner if owner == "base" or owner.startswith("tool") else f"{owner}'s place in its link"
    kind = "turn about" if len(number) == 2 else "shift along"
    return f"the {kind} {number[-1]} of {'the ' if owner in ('base', 'tool') else ''}{where}"


def chosen(parameters: str | Sequence[str], models: Sequence[Model]) -> tuple[NumberName, ...]:
    """The numbers that a word or a list stands for.

    Args:
        parameters: One of `CHOICES`, several joined by ``+`` (``"offsets+tool"``), or a list of words: a joint's name
            for all of its numbers, ``"joint.zero"`` for one, ``"base"`` or ``"tool"`` for their six.
        models: The chains.

    Raises:
        InvalidInputError: Nothing is chosen.
        UnknownNameError: No such choice, joint or number; carries near matches.
    """
    words = parameters.split("+") if isinstance(parameters, str) else list(parameters)
    every = every_name(models)
    keys, owners = {key_of(name): name for name in every}, {owner for owner, _ in every}
    found: dict[NumberName, None] = {}
    for word in (word.strip() for word in words):
        if word in CHOICES:
            names = _of_choice(word, models)
        elif word in owners:
            names = [name for name in every if name[0] == word]
        elif word in keys:
            names = [keys[word]]
        else:
            raise UnknownNameError("parameters", word, (*CHOICES, *sorted(owners), *keys))
        found.update(dict.fromkeys(names))
    if not found:
        raise InvalidInputError("parameters", f"one of {', '.join(CHOICES)}, or names of numbers", repr(parameters))
    return tuple(found)


def _of_choice(word: str, models: Sequence[Model]) -> list[NumberName]:
    joints = {joint.name: joint for model in models for joint in model.joints}
    if word == "offsets":
        return [(name, "zero") for name in joints]
    if word == "ratios":
        return [(name, number) for name in joints for number in ("zero", "ratio")]
    lines = [
        (name, motion)
        for name, joint in joints.items()
        for motion in (_LINE if not joint.slides else tuple(m for m in placed_by(joint) if m in ("rx", "ry")))
    ]
    return [*lines, *((model.tool_name, motion) for model in models for motion in MOTIONS)]
