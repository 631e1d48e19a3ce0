"""`nao-kin check --dh` and `--against`: what a comparison says, as findings of the file that is checked."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nao_kin.checks.departure_finding import departure_finding

if TYPE_CHECKING:
    from collections.abc import Iterator

    from nao_kin.checks.finding import Finding
    from nao_kin.crosscheck import Comparison
    from nao_kin.robot.robot import Robot

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
    from nao_kin.dh.dh_chain import DHChain
    from nao_kin.robot.robot import load

    chain = DHChain.from_file(table)
    robot = load(path)
    found = compare(chain, robot.chain(chain.base_name, chain.tip_name))
    hint = "Look at that joint's origin and axis, and at its row in the table."
    if not found.agrees and found.explanation.steps:
        hint = f"They agree after changing in the table: {'; '.join(map(str, found.explanation.steps))}."
    yield from _finding(path, "departs-from-table", found, _joint_above(robot, chain.tip_name), hint)


def departures_from_model(path: str, other: str) -> Iterator[Finding]:
    """Where the chains from the root to the ends that both files have move otherwise than in the other file.

    Raises:
        UrdfError: One of the files cannot be read.
    """
    from nao_kin.robot.robot import load

    ours, theirs = load(path), load(other)
    frames = set(theirs.frame_names)
    if ours.root not in frames:
        message = f"The root {ours.root!r} is not a frame of {other}, so nothing can be compared."
        yield departure_finding(path, "departs-from-model", None, message, "Do both files describe the same robot?")
        return
    seen: set[str] = set()
    for tip in _ends(ours):
        for finding in _end_findings(path, ours, theirs, tip, other):
            if finding.element not in seen:  # ends that share joints depart at the same one
                seen.add(finding.element)
                yield finding


def _end_findings(path: str, ours: Robot, theirs: Robot, tip: str, other: str) -> Iterator[Finding]:
    from nao_kin.crosscheck import compare

    above, code = _joint_above(ours, tip), "departs-from-model"
    if tip not in theirs.frame_names:
        yield departure_finding(path, code, above, f"The frame {tip!r} is not in {other}.")
        return
    names, others = (_moving_on_the_way(robot, ours.root, tip) for robot in (ours, theirs))
    if names != others:
        message = f"The way to {tip!r} has other joints than in {other}: {_listed(others)}."
        name = next((a for a, b in zip(names, others, strict=False) if a != b), names[-1])
        yield departure_finding(path, code, name, message)
        return
    found = compare(theirs.chain(ours.root, tip), ours.chain(ours.root, tip), samples=_SAMPLES)
    yield from _finding(path, code, found, above, "Look at that joint's origin and axis in both files.")


def _finding(path: str, code: str, found: Comparison, above: str | None, hint: str) -> Iterator[Finding]:
    """The one place where a comparison becomes a finding; what explains it goes into the hint.

    Args:
        path: The file that is checked.
        code: Of the finding.
        found: The comparison, the file's chain second.
        above: The joint that the tip hangs on, where the finding stands if only the ends differ.
        hint: What to look at.
    """
    departure = found.first_departure
    if departure is None:
        return
    worst = f"{found.max_position_error * 1e3:.4g} mm and {found.max_rotation_error:.4g} rad at worst"
    where = "the joints move alike, only the ends differ"
    if departure.joint is not None:
        where = f"they part at the joint {departure.joint!r}, or at the fixed transform that leads to it"
    message = f"{found.b.name} and {found.a.name} are apart by {worst}: {where}."
    yield departure_finding(path, code, departure.joint or above, message, hint)


def _joint_above(robot: Robot, link: str) -> str | None:
    return next((joint.name for joint in robot.document.joints if joint.child == link), None)


def _moving_on_the_way(robot: Robot, base: str, tip: str) -> tuple[str, ...]:
    """Names of the joints from base to tip that move, whichever way they are met."""
    up, down = robot.path(base, tip)
    return tuple(joint.name for joint in (*up, *down) if joint.kind != "fixed")


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
