"""Where modules have gone: a documented old place imports the module at its new one.

A finder on `sys.meta_path` answers for old names only, after every other finder has passed.
"""

from __future__ import annotations

import importlib
import importlib.util
import sys
from importlib.abc import Loader, MetaPathFinder
from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from collections.abc import Sequence
    from importlib.machinery import ModuleSpec
    from types import ModuleType

__all__ = ["MOVED", "answer_for_old_places"]

MOVED: Final = {
    "documents.practicum_ik": "documents.practicum.position_ik",
    "documents.practicum_tasks": "documents.practicum.practicum_tasks",
    "documents.hexapod_article": "documents.hexapod.hexapod_article",
    "analytic.batch": "analytic.solution_batch",
    "analytic.body": "analytic.hexapod.body",
    "analytic.intervals": "analytic.nao.intervals",
    "analytic.looking": "analytic.nao.looking",
    "analytic.symbolic_head": "analytic.nao.symbolic_head",
    "dh_file": "dh.table_file",
    "dh_from_chain": "dh.from_chain",
    "dh_row": "dh.dh_row",
    "dh_to_urdf": "dh.to_urdf",
    "documents.ledger": "documents.judging",
    "ik.catalogue": "ik.methods",
    "ik.loop": "ik.reference_loop",
    "ik.tree": "ik.tips.tree_solver",
    "ik.tree_problem": "ik.tips.tree_problem",
    "joint_lines": "dh.joint_lines",
    "known": "robot.known",
    "motion.feet": "motion.nao.feet",
    "motion.footfall": "motion.hexapod.footfall",
    "motion.gait": "motion.hexapod.gait",
    "motion.guard": "motion.loop.guard",
    "motion.keyframe_file": "motion.nao.keyframe_file",
    "motion.keyframes": "motion.nao.keyframes",
    "motion.messages": "motion.loop.messages",
    "motion.plants": "motion.loop.plants",
    "motion.pointing": "motion.nao.pointing",
    "motion.profile": "motion.loop.profile",
    "motion.servo": "motion.loop.servo",
    "motion.stream": "motion.loop.stream",
    "motion.torso": "motion.nao.feet",
    "motion.transports": "motion.loop.transports",
    "motion.tuning": "motion.loop.servo",
    "motion.walk_command": "motion.hexapod.walk_request",
    "motion.walk_plan": "motion.hexapod.gait",
    "motors": "robot.motors",
    "trajectory.file_fields": "trajectory.files.reading",
    "trajectory.file_json": "trajectory.files.reading",
    "trajectory.file_rows": "trajectory.files.reading",
    "trajectory.joint_motion": "trajectory.joint_space",
    "trajectory.sampling": "trajectory.instants",
    "tree": "robot.tree",
    "urdf_chain": "robot.urdf_chain",
    "urdf_path": "robot.path",
}
"""Old module to new one, without the package's name."""


class _OldPlaces(MetaPathFinder):
    """Finds the modules of `MOVED`."""

    def find_spec(
        self,
        fullname: str,
        path: Sequence[str] | None = None,  # noqa: ARG002 (the import system's own signature)
        target: ModuleType | None = None,  # noqa: ARG002
    ) -> ModuleSpec | None:
        """The module at its new place, for an old one."""
        package, _, old = fullname.partition(".")
        if package != "nao_kin" or old not in MOVED:
            return None
        return importlib.util.spec_from_loader(fullname, _AtItsNewPlace(f"nao_kin.{MOVED[old]}"))


class _AtItsNewPlace(Loader):
    """Hands over the module itself, not a copy: a class imported from both places is one class."""

    def __init__(self, name: str) -> None:
        self._name = name

    def create_module(self, spec: ModuleSpec) -> ModuleType:  # noqa: ARG002
        """Imports it."""
        module = importlib.import_module(self._name)
        self._own_spec = module.__spec__
        return module

    def exec_module(self, module: ModuleType) -> None:
        """Leaves it as it is."""
        module.__spec__ = self._own_spec  # the import system has just written the old place's over it


def answer_for_old_places() -> None:
    """Has old places answered for in this process; once is enough."""
    if not any(isinstance(finder, _OldPlaces) for finder in sys.meta_path):
        sys.meta_path.append(_OldPlaces())
