"""One file through all rules."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Final, TypedDict

from nao_kin.checks.catalogue import CATALOGUE, require_codes
from nao_kin.checks.finding import Report, Severity
from nao_kin.checks.listing import MOST_OF_A_CODE, Listing, bounded, finding_of
from nao_kin.checks.rules import control_rules as control
from nao_kin.checks.rules import figure_rules as figures
from nao_kin.checks.rules import inertia_rules as inertia
from nao_kin.checks.rules import joint_rules as joints
from nao_kin.checks.rules import launch_rules as launch
from nao_kin.checks.rules import mesh_rules as meshes
from nao_kin.checks.rules import name_rules as names
from nao_kin.checks.rules import tree_rules as tree
from nao_kin.checks.rules import vocabulary_rules as vocabulary
from nao_kin.checks.subject import Subject
from nao_kin.errors import UnknownNameError, UrdfError
from nao_kin.robot.known import KNOWN_ROBOTS, find_known, robot_file
from nao_kin.robot.sources import is_path
from nao_kin.urdf.document import UNREADABLE, read_bytes, read_urdf
from nao_kin.urdf.outline import Defect, Outline
from nao_kin.urdf.positions import Positions
from nao_kin.urdf.safe_xml import read_tree
from nao_kin.urdf.structure import STAGES, TOLERATED
from nao_kin.urdf.xacro import expand_xacro, is_xacro_file

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Iterator, Mapping

    from nao_kin.checks.finding import Finding
    from nao_kin.checks.subject import Rule
    from nao_kin.urdf.resources import MeshRoots
    from nao_kin.urdf.xacro import Expansion

__all__ = ["MOST_OF_A_CODE", "check", "check_bytes", "departure_finding", "finding_of"]

TEXT_RULES: Final[tuple[Rule, ...]] = (
    vocabulary.later_words,
    vocabulary.instructions,
    vocabulary.unknown_words,
    vocabulary.repeated_elements,
    names.duplicate_materials,
    names.undefined_materials,
    names.shared_names,
    names.similar_names,
    joints.axes_of_other_length,
    joints.empty_axes,
    joints.incomplete_limits,
    joints.zero_ranges,
    joints.continuous_with_limits,
    joints.slips_between_limits,
    joints.limits_in_other_units,
    joints.mimics_of_fixed_joints,
    figures.other_readers_numbers,
    figures.stray_blanks,
    figures.quaternions_of_other_length,
    figures.colours,
    figures.lengths_in_millimetres,
    figures.angles_in_degrees,
    inertia.incomplete_inertials,
    inertia.empty_inertials,
    inertia.principal_moments,
    inertia.moving_without_inertia,
    inertia.masses_out_of_scale,
    meshes.shapes,
    meshes.missing_collisions,
    meshes.mesh_files,
    meshes.mesh_contents,
    control.controlled_joints,
    control.transmission_joints,
    control.gazebo_references,
    launch.blanks_in_names,
    launch.colons_in_comments,
)
"""Rules on the text, for every file that is a URDF at all; each skips what another one reports."""

_BREAKS_THE_TREE: Final = frozenset(
    {
        "no-name",
        "duplicate-link",
        "no-parent",
        "no-child",
        "unknown-parent",
        "unknown-child",
        "repeated-end",
        "self-joint",
    }
)
"""Defects after which it says nothing about a file that its links are no tree."""


class _Options(TypedDict):
    """What is the same for every kind of file."""

    packages: MeshRoots
    thorough: bool
    select: Collection[str]
    ignore: Collection[str]


def check(
    robot: str | os.PathLike[str],
    *,
    packages: MeshRoots = (),
    thorough: bool = False,
    select: Collection[str] = (),
    ignore: Collection[str] = (),
    urdf: str | os.PathLike[str] | None = None,
    arguments: Mapping[str, object] | None = None,
) -> Report:
    """Check a URDF or SRDF file, by path, or the file of a known robot, by name.

    Args:
        robot: What `nao_kin.load` takes: text that ends in ``.urdf`` or contains a path separator is a path. What ends
            in ``.srdf`` is MoveIt's file beside a URDF, and in ``.xacro`` one of macros, which is expanded first.
        packages: Package folders by name, or folders that hold packages, for ``package://`` in mesh names.
        thorough: Also open every mesh, however many, and hold Pinocchio against yourdfpy at random postures.
        select: Report these codes only; all if empty.
        ignore: Do not report these.
        urdf: The URDF that an SRDF is about; looked for beside it if None.
        arguments: Values of the ``<xacro:arg>`` of a file of macros.

    Returns:
        Every finding with its line, sorted. A file that cannot be parsed is a finding too.

    Raises:
        UrdfError: There is no such file, or it is none that can be read at all.
        UnknownNameError: No robot or no code of that name; carries near matches.
        MissingExtraError: The robot's files come with an optional extra.
    """
    require_codes((*select, *ignore))
    path = _path_of(robot)
    try:
        data = read_bytes(path)
    except UrdfError as refusal:
        if refusal.code == UNREADABLE:
            raise
        return Listing(path, select, ignore).report_refusal(refusal, b"")
    folder = Path(path).absolute().parent
    if is_xacro_file(path):
        try:
            expansion = expand_xacro(path, arguments, packages)
        except UrdfError as refusal:
            return Listing(path, select, ignore).report_refusal(refusal, b"")
        options: _Options = {"packages": packages, "thorough": thorough, "select": select, "ignore": ignore}
        return check_bytes(expansion.data, path, folder=folder, expansion=expansion, **options)
    if path.endswith(".srdf"):
        return _check_srdf(data, Listing(path, select, ignore), folder, urdf)
    return check_bytes(data, path, folder=folder, packages=packages, thorough=thorough, select=select, ignore=ignore)


def check_bytes(
    data: bytes,
    path: str = "<urdf>",
    *,
    folder: Path | None = None,
    packages: MeshRoots = (),
    thorough: bool = False,
    select: Collection[str] = (),
    ignore: Collection[str] = (),
    expansion: Expansion | None = None,
) -> Report:
    """Check a URDF that is in memory.

    Args:
        data: The whole file.
        path: How findings name it.
        folder: Where relative mesh names start; None where the text comes from no file.
        packages: See `check`.
        thorough: See `check`.
        select: See `check`.
        ignore: See `check`.
        expansion: The macros that it was expanded from; findings then name their files and lines.

    Returns:
        See `check`.

    Raises:
        UnknownNameError: No code of that name.
    """
    require_codes((*select, *ignore))
    listing = Listing(path, select, ignore)
    try:
        root = read_tree(data, path)
    except UrdfError as refusal:
        return listing.report_refusal(refusal, data)
    known = KNOWN_ROBOTS.get(root.get("name", ""))
    subject = Subject(path, data, Outline(root), Positions.of(data, root), folder, packages, thorough, known, expansion)
    for defects in _examination(subject):
        listing.add(subject, defects)
    return listing.report()


def _check_srdf(data: bytes, listing: Listing, folder: Path, urdf: str | os.PathLike[str] | None) -> Report:
    from nao_kin.checks.srdf import RULES, Semantics, urdf_of

    try:
        root = read_tree(data, listing.path)
    except UrdfError as refusal:
        return listing.report_refusal(refusal, data)
    subject = Subject(listing.path, data, Outline(root), Positions.of(data, root), folder)
    semantics = Semantics(root, urdf_of(root, folder) if urdf is None else read_urdf(urdf))
    for rule in RULES:
        listing.add(subject, bounded(rule(semantics)))
    return listing.report()


def _examination(subject: Subject) -> Iterator[Iterable[Defect]]:
    """What every rule finds, rule by rule, as far as the findings so far let later rules mean something."""
    outline = subject.outline
    *early, local, connected = STAGES
    for stage in early:
        found = [list(bounded(rule(outline))) for rule in stage]
        yield from found
        if any(found):
            return
    found = [list(bounded(rule(outline))) for rule in local]
    yield from found
    sound = not any(found)
    tolerated = [list(bounded(rule(outline))) for rule in TOLERATED]
    yield from tolerated
    # Whoever computes with it is told; the rules on the model would only say it again.
    sound = sound and not any(_is_error(defect) for defects in tolerated for defect in defects)
    if not any(defect.code in _BREAKS_THE_TREE for defects in found for defect in defects):
        found = [list(bounded(rule(outline))) for rule in connected]
        found.append(list(bounded(tree.unreachable_links(subject))))
        yield from found
        sound = sound and not any(found)
    for rule in TEXT_RULES:
        yield bounded(rule(subject))
    if sound:
        for model_rule in _model_rules(subject.thorough):
            yield bounded(model_rule(subject))


def _is_error(defect: Defect) -> bool:
    return CATALOGUE[defect.code].severity is Severity.error


def _model_rules(thorough: bool) -> tuple[Rule, ...]:
    """The rules that compute with the model, for files without structural defects."""
    from nao_kin.checks.rules import collision_rules as collision
    from nao_kin.checks.rules import mirror_rules as mirror
    from nao_kin.checks.rules import pose_rules as poses
    from nao_kin.checks.rules import weight_rules as weight

    rules: tuple[Rule, ...] = (
        poses.coupled_ranges,
        poses.coupled_limits,
        poses.finite_poses,
        mirror.geometry_of_twins,
        mirror.limits_of_twins,
        mirror.inertia_of_twins,
        collision.self_collisions,
        weight.balance_at_zero,
    )
    return (*rules, poses.readers_agree, weight.efforts_against_gravity) if thorough else rules


def _path_of(robot: str | os.PathLike[str]) -> str:
    """The path that is meant, by the rule of `nao_kin.load`."""
    if isinstance(robot, str) and not is_path(robot):
        try:
            return os.fspath(robot_file(find_known(robot)))
        except UnknownNameError:
            if os.path.isfile(robot):  # noqa: PTH113 - false, where Path would raise, for a name too long
                return robot
            raise
    return os.fspath(robot)


def departure_finding(
    path: str | os.PathLike[str], code: str, joint: str | None, message: str, hint: str = ""
) -> Finding:
    """A finding at a joint of a file, or at its root where no joint is named or the file has none of that name.

    Args:
        path: The file that departs.
        code: ``"departs-from-table"`` or ``"departs-from-model"``.
        joint: Where it departs.
        message: How, one sentence.
        hint: What would make the two agree.

    Raises:
        UrdfError: The file cannot be read.
    """
    name = os.fspath(path)
    data = read_bytes(name)
    root = read_tree(data, name)
    outline = Outline(root)
    at = outline.joint_by_name.get(joint or "", root)
    subject = Subject(name, data, outline, Positions.of(data, root), Path(name).absolute().parent)
    return finding_of(subject, Defect(code, at, message, hint, "name"))
