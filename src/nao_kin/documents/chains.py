"""Every hand-written chain of the documents by name, each with the model it is about."""

from __future__ import annotations

import importlib
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from nao_kin.errors import UnknownNameError

if TYPE_CHECKING:
    from nao_kin.dh.dh_chain import DHChain

__all__ = ["DOCUMENT_CHAINS", "DocumentChain", "document_chain", "document_chain_names", "documents_of"]


@dataclass(frozen=True, slots=True)
class DocumentChain:
    """A chain of a document and the chain of a robot that it describes.

    Attributes:
        maker: Module of this package, function in it and its arguments that make the chain as printed.
        robot: Known robot that the document is about.
        base: Base frame there.
        tip: Tip frame there.
        source: Document and place in it.
    """

    maker: tuple[str, ...]
    robot: str
    base: str
    tip: str
    source: str

    def build(self) -> DHChain:
        """The chain as printed; its module is imported now, so that listing names costs nothing."""
        module, function, *arguments = self.maker
        chain: DHChain = getattr(importlib.import_module(f"nao_kin.documents.{module}"), function)(*arguments)
        return chain


_KOFINAS = "Kofinas et al., NAOKinematics library"

DOCUMENT_CHAINS: Final[dict[str, DocumentChain]] = {
    "thesis_left_arm": DocumentChain(
        ("thesis.thesis_arms", "left_arm"), "nao_v50_h21", "torso", "LArm", "Bischoff 2016, Table 3 and (3.1.0.1)"
    ),
    "thesis_right_arm": DocumentChain(
        ("thesis.thesis_arms", "right_arm"), "nao_v50_h21", "torso", "RArm", "Bischoff 2016, Table 4 and (3.1.0.2)"
    ),
    "matlab_head": DocumentChain(
        ("matlab.head_example", "head"),
        "nao_v33_h25",
        "torso",
        "CameraTop_frame",
        "MATLAB example, getKinematicChain('head')",
    ),
    "matlab_left_hand": DocumentChain(
        ("matlab.head_example", "left_hand"),
        "nao_v33_h21",
        "torso",
        "LArm",
        "MATLAB example, getKinematicChain('lefthand')",
    ),
    "practicum_jaco2": DocumentChain(
        ("practicum.practicum_sheet", "jaco2"),
        "jaco2",
        "link_base",
        "end_effector",
        "Practicum task 1, Kinova's constants",
    ),
    "kofinas_head": DocumentChain(("kofinas", "head"), "nao_v33_h25", "torso", "Head", _KOFINAS),
    "kofinas_left_arm": DocumentChain(("kofinas", "arm", "left"), "nao_v33_h25", "torso", "LArm", _KOFINAS),
    "kofinas_right_arm": DocumentChain(("kofinas", "arm", "right"), "nao_v33_h25", "torso", "RArm", _KOFINAS),
    "kofinas_left_arm_h21": DocumentChain(("kofinas", "arm", "left", "h21"), "nao_v33_h21", "torso", "LArm", _KOFINAS),
    "kofinas_right_arm_h21": DocumentChain(
        ("kofinas", "arm", "right", "h21"), "nao_v33_h21", "torso", "RArm", _KOFINAS
    ),
    "kofinas_left_leg": DocumentChain(("kofinas", "leg", "left"), "nao_v33_h25", "torso", "LLeg", _KOFINAS),
    "kofinas_right_leg": DocumentChain(("kofinas", "leg", "right"), "nao_v33_h25", "torso", "RLeg", _KOFINAS),
}


def document_chain(name: str) -> DHChain:
    """A chain of the source documents, as printed.

    Args:
        name: One of `document_chain_names`.

    Returns:
        The table, converted to metres and radians, in the convention that its document names.

    Raises:
        UnknownNameError: There is none of that name; carries near matches.
    """
    return entry(name).build()


def document_chain_names() -> tuple[str, ...]:
    """The names that `document_chain` takes."""
    return tuple(DOCUMENT_CHAINS)


def entry(name: str) -> DocumentChain:
    """The entry of a chain: its source and the model it is about.

    Raises:
        UnknownNameError: There is none of that name; carries near matches.
    """
    try:
        return DOCUMENT_CHAINS[name]
    except KeyError:
        raise UnknownNameError("document chain", name, DOCUMENT_CHAINS) from None


def documents_of(robot: str, base: str, tip: str) -> tuple[str, ...]:
    """Names of the document chains that describe this path of a known robot."""
    return tuple(n for n, d in DOCUMENT_CHAINS.items() if (d.robot, d.base, d.tip) == (robot, base, tip))
