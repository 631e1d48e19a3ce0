"""`nao-kin check --dh` and `--against`: what a comparison says, as findings of the file that is checked."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nao_kin.checks.departure import departure_finding

if TYPE_CHECKING:
    from collections.abc import Iterator

    from nao_kin.checks.finding import Finding
    from nao_kin.crosscheck import Comparison
    from nao_kin.robot import Robot

__all__ = ["departures_from_model", "departures_from_table"]

_SAMPLES = 200  # a fault shows at almost any configuration


def departures_from_table(path: str, table: str) -> Iterator[Finding]:
    """Where the chain between a table's base and tip moves otherwise than the table says.

    Raises:
        UnknownNameError: The file has no frame of the name of the table's base or tip.
        TableFileError: The table cannot be read.
        UrdfError: The file cannot be read.
    """
    from nao_kin.crosscheck import compare
    from nao_kin.dh import DHChain
    from nao_kin.robot import load

    chain = DHChain.from_file(table)
    model = load(path).chain(chain.base_name, chain.tip_name)
    yield from _finding(path, "departs-from-table", compare(chain, model))


def departures_from_model(path: str, other: str) -> Iterator[Finding]:
    """Where the chains from the root to the ends that both files have move otherwise than in the other file.

    Raises:
        UrdfError: One of the files cannot be read.
    """
    from nao_kin.crosscheck import compare
    from nao_kin.robot import load

    ours, theirs = load(path), load(other)
    frames = set(theirs.frame_names)
    if ours.root not in frames:
        message = f"The root {ours.root!r} is not a frame of {other}, so nothing can be compared."
        yield departure_finding(path, "departs-from-model", None, message, "Do both files describe the same robot?")
        return
    seen: set[str] = set()
    for tip in _ends(ours):
        if tip not in frames:
            message = f"The frame {tip!r} is not in {other}."
            above = next(joint.name for joint in ours.document.joints if joint.child == tip)
            yield departure_finding(path, "departs-from-model", above, message)
            continue
        chain, twin = ours.chain(ours.root, tip), theirs.chain(ours.root, tip)
        if chain.path_joint_names != twin.path_joint_names:
            message = f"The way to {tip!r} has other joints than in {other}: {_listed(twin.path_joint_names)}."
            differs = zip(chain.path_joint_names, twin.path_joint_names, strict=False)
            name = next((a for a, b in differs if a != b), chain.path_joint_names[-1])
            yield departure_finding(path, "departs-from-model", name, message)
            continue
        for finding in _finding(path, "departs-from-model", compare(twin, chain, samples=_SAMPLES)):
            if finding.element not in seen:  # ends that share joints depart at the same one
                seen.add(finding.element)
                yield finding


def _finding(path: str, code: str, found: Comparison) -> Iterator[Finding]:
    """The one place where a comparison becomes a finding; what explains it goes into the hint."""
    if found.agrees:
        return
    departure = found.first_departure
    worst = f"{found.max_position_error * 1e3:.4g} mm and {found.max_rotation_error:.4g} rad at worst"
    where = "its joints move alike, only the ends differ"
    if departure is not None and departure.joint is not None:
        where = f"they part at the joint {departure.joint!r}, or at the fixed transform that leads to it"
    message = f"{found.b.name} and {found.a.name} are apart by {worst}: {where}."
    hint = "Look at that joint's origin and axis, and at its row in the table."
    yield departure_finding(path, code, None if departure is None else departure.joint, message, hint)


def _ends(robot: Robot) -> list[str]:
    """The links that nothing hangs on and that move against the root."""
    parents = {joint.parent for joint in robot.document.joints}
    return [
        link.name
        for link in robot.document.links
        if link.name not in parents and any(j.kind != "fixed" for j in robot.path(robot.root, link.name)[1])
    ]


def _listed(names: tuple[str, ...]) -> str:
    return ", ".join(names[:8]) + (", …" if len(names) > 8 else "")
