"""`nao-kin bench closed`: every closed form against random joints, Newton, singular goals and Pinocchio's clock."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from nao_kin.bench.sheet import Goal, GoalsOption, Heading, Machine, Sheet, conclude
from nao_kin.output import FormatOption, OutputFormat, progress

if TYPE_CHECKING:
    import numpy as np

    from nao_kin.bench.closed_cases import Case

__all__ = ["closed"]

_SAME = 1e-9  # [rad]: joints this near are recovered
_REGULAR = 1e-6  # least singular value from which on a goal says what its joints are to 1e-9
_RESIDUAL = 1e-10  # [m, rad]
_MISSING = 1e-5  # [rad]: Newton's solutions farther than this from every branch are missing
_TIMED = 1000  # goals, and computeFrameJacobian calls, timed at once: longer jobs are seldom left alone
_COSTS = {"nao_head": 1.0, "nao_arm_h21": 1.0, "nao_arm_h25": 1.0}
_OTHER_COST = 2.0  # computeFrameJacobian calls for a leg with its eight branches


def closed(
    targets: Annotated[int, typer.Option(min=1, help="Random goals of each chain and kind.")] = 10_000,
    newton: Annotated[int, typer.Option(min=1, help="Of these, goals that Newton searches for more branches.")] = 200,
    starts: Annotated[int, typer.Option(min=1, help="Newton's starts for each.")] = 64,
    rounds: Annotated[int, typer.Option(min=1, help="Alternations; the least times are compared.")] = 9,
    seed: Annotated[int, typer.Option(min=0, help="Seed of all random numbers.")] = 21,
    goals: GoalsOption = True,
    format: FormatOption = OutputFormat.text,
) -> None:
    """Closed forms: recovered joints, residuals, missing branches, singular goals, and what a goal costs."""
    import numpy as np

    from nao_kin.bench.closed_cases import cases

    machine, rng = Machine(), np.random.default_rng(seed)
    every = list(cases(targets, rng))
    rows, hard = list[dict[str, Any]](), list[dict[str, Any]]()
    for case in progress(every, "closed forms", len(every)):
        rows.append(_recovery(case) | _completeness(case, newton, starts, rng) | _cost(case, rounds))
        hard += _hard(case, max(10, targets // 20), rng)
    hard = _by_form(hard)
    sheets = [
        Sheet("closed", f"{targets} goals made of random joints within limits", _HEADINGS, rows),
        Sheet("strata", "goals where formulas stumble", _HARD_HEADINGS, hard),
        _folded(targets, rng),
    ]
    conclude(machine, sheets, [*_bounds(rows), *_hard_bounds(hard)], list(_NOTES), format, goals)


_HEADINGS = (
    Heading("case", "chain and goal"),
    Heading("recovered_of", "recovered"),
    Heading("branches", "branches", ".2f"),
    Heading("residual", "residual", ".0e"),
    Heading("missing", "missing", "d"),
    Heading("cost", "CFJ", ".2f"),
)
_HARD_HEADINGS = (
    Heading("form", "closed form"),
    Heading("stratum", "goals"),
    Heading("targets", "number", "d"),
    Heading("wrong", "wrong", "d"),
    Heading("nan", "NaN", "d"),
    Heading("residual", "residual", ".0e"),
)
_NOTES = (
    f"Recovered: goals whose joints are among the solutions to {_SAME:g} rad, of those with a least singular value "
    f"above {_REGULAR:g}. Branches: solutions a goal, in or out of limits. Residual: largest error of any [m, rad]. "
    "Missing: solutions that Newton found and the closed form did not. Wrong: goals without solution, or beyond reach "
    "with one. CFJ: cost of a goal with all its branches on one thread, before judging, in computeFrameJacobian calls "
    "of Pinocchio from Python; the least times of both.",
)


def _recovery(case: Case) -> dict[str, Any]:
    """Whether the joints that made each goal are among its solutions, and how exact all solutions are."""
    import numpy as np

    from nao_kin.bench.all_solutions import least_singular_value
    from nao_kin.bench.closed_cases import found_by

    solutions, kind = found_by(case), case.found.kind
    moves = np.abs((solutions.q - case.Q[:, None, :] + np.pi) % (2.0 * np.pi) - np.pi).max(axis=2)
    apart = np.where(solutions.found, moves, np.inf).min(axis=1)
    values = least_singular_value(kind, case.goals, case.chain, case.Q, np.isnan(case.locked[0]))
    regular = values > _REGULAR
    errors = np.fmax(np.nan_to_num(solutions.position_error), np.nan_to_num(solutions.rotation_error))
    recovered = int((regular & (apart <= _SAME)).sum())
    return {
        "case": f"{case.name}, {kind}",
        "form": case.found.form.name,
        "goal": kind,
        "recovered_of": f"{recovered}/{int(regular.sum())}",
        "targets": len(case.Q),
        "regular": int(regular.sum()),
        "recovered": recovered,
        "lost": int((~solutions.found.any(axis=1)).sum()),
        "apart": float(apart[regular].max(initial=0.0)),
        "branches": float(solutions.found.sum() / len(case.Q)),
        "residual": float(errors[solutions.found].max(initial=0.0)),
    }


def _completeness(case: Case, count: int, starts: int, rng: np.random.Generator) -> dict[str, Any]:
    """How many solutions Newton finds, and how many of them are not among the closed form's."""
    from dataclasses import replace

    import numpy as np

    from nao_kin.bench.all_solutions import apart, least_singular_value, multi_start
    from nao_kin.bench.closed_cases import found_by

    some = replace(case, Q=case.Q[:count], goals=case.goals[:count])
    closed_form, kind, locked = found_by(some), case.found.kind, some.locked
    by_newton = missing = 0
    for i, solutions in enumerate(multi_start(case.chain, kind, some.goals, locked, starts, rng)):
        if not len(solutions):
            continue
        goals = some.goals[[i] * len(solutions)]
        values = least_singular_value(kind, goals, case.chain, solutions, np.isnan(locked[0]))
        by_newton += len(solutions)
        branches = closed_form.q[i][closed_form.found[i]]
        missing += sum(v > _REGULAR and apart(branches, q) > _MISSING for v, q in zip(values, solutions, strict=True))
    return {"by_newton": by_newton, "missing": missing, "searched": len(some.Q)}


def _cost(case: Case, rounds: int) -> dict[str, float]:
    """A goal's time on one thread over that of a computeFrameJacobian call, alternating."""
    import numpy as np
    import pinocchio as pin

    from nao_kin.analytic.form import GOALS
    from nao_kin.bench.measuring import in_turns, one_thread
    from nao_kin.robot.robot import load

    found, goals = case.found, np.ascontiguousarray(case.goals[:_TIMED])
    N = len(goals)
    rows = np.empty((N, found.request.branches, found.form.joints + 2))
    counts, kind, numbers = np.zeros(N, dtype=np.int64), GOALS[found.kind], found.geometry.parameters
    given = np.ascontiguousarray(case.Q[:N, case.given]) if case.given else np.zeros((1, 1))
    model: Any = load(case.chain.robot.name).model
    data, tip, values = model.createData(), model.getFrameId(case.chain.tip), pin.neutral(model)
    jacobian, aligned = pin.computeFrameJacobian, pin.ReferenceFrame.LOCAL_WORLD_ALIGNED

    def ours() -> None:
        found.form.solve_many(numbers, kind, goals, given, 1e-6, rows, counts)

    def theirs() -> None:
        for _ in range(_TIMED):
            jacobian(model, data, values, tip, aligned)

    with one_thread():
        ours()
        times = in_turns({"ours": ours, "theirs": theirs}, range(rounds), {"ours": 5, "theirs": 5})
    return {"cost": min(times["ours"]) / N / (min(times["theirs"]) / _TIMED)}


def _hard(case: Case, count: int, rng: np.random.Generator) -> list[dict[str, Any]]:
    """Goals at limits, singularities and the border: all have a solution; goals just beyond: none has."""
    from nao_kin.bench.closed_cases import strata, unreachable

    rows = [_hard_row(hard, stratum, count) for stratum, hard in strata(case, count, rng)]
    if (missed := unreachable(case, count, rng)) is not None:
        rows.append(_hard_row(missed, "3 µm beyond", 0))
    return rows


def _hard_row(case: Case, stratum: str, wanted: int) -> dict[str, Any]:
    import numpy as np

    from nao_kin.bench.closed_cases import found_by

    solutions = found_by(case)
    errors = np.fmax(np.nan_to_num(solutions.position_error), np.nan_to_num(solutions.rotation_error))
    return {
        "form": case.found.form.name,
        "stratum": stratum,
        "targets": len(case.Q),
        "wrong": abs(int(solutions.found.any(axis=1).sum()) - wanted),
        "nan": int(np.isnan(solutions.q[solutions.found]).any(axis=1).sum()),
        "residual": float(errors[solutions.found].max(initial=0.0)),
    }


def _by_form(rows: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """The rows of each form and stratum in one."""
    whole: dict[tuple[str, str], dict[str, Any]] = {}
    for row in rows:
        same = whole.setdefault((row["form"], row["stratum"]), row | {"targets": 0, "wrong": 0, "nan": 0})
        for key in ("targets", "wrong", "nan"):
            same[key] += row[key]
        same["residual"] = max(same["residual"], row["residual"])
    return list(whole.values())


def _folded(count: int, rng: np.random.Generator) -> Sheet:
    """The thesis' folded arm, elbow offset in the shoulder and no hand offset, held against the true one."""
    from dataclasses import replace

    import numpy as np

    from nao_kin.chain import random_configurations
    from nao_kin.documents.kofinas import V33_LENGTHS, arm
    from nao_kin.robot.robot import load

    lengths = V33_LENGTHS
    sideways = lengths.shoulder_offset_y + lengths.elbow_offset_y
    folded = arm("left", "h21", replace(lengths, shoulder_offset_y=sideways, elbow_offset_y=0.0, hand_offset_z=0.0))
    true = load("nao_v50_h21").chain("left_arm")
    Q = random_configurations(true, count, rng)
    wanted, offset = true.poses(Q), folded.poses(Q)
    same = np.linalg.norm(wanted[:, :3, 3] - offset[:, :3, 3], axis=1) * 1e3
    yaws = Q[:, 2]
    miss, found = _folded_position(folded, true, wanted, yaws)
    rows = [
        {"what": "same joints: distance of the tips", "of": count, "median": np.median(same), "most": same.max()},
        {"what": "its joints for a position", "of": found, "median": np.median(miss), "most": miss.max()},
    ]
    headings = (
        Heading("what", "thesis' folded arm on the true one"),
        Heading("of", "goals", "d"),
        Heading("median", "median [mm]", ".1f"),
        Heading("most", "largest [mm]", ".1f"),
    )
    return Sheet("folded", f"{true.name}, what leaving out the elbow's and the hand's offset costs", headings, rows)


def _folded_position(folded: Any, true: Any, wanted: Any, yaws: Any) -> tuple[Any, int]:
    """How far the true tip is from a wanted position with the folded arm's joints for it [mm], and for how many goals.

    Of its solutions with the right elbow yaw the one that is nearest to the goal counts.
    """
    import numpy as np

    from nao_kin.analytic.solution_batch import solve_all_batch

    solutions = solve_all_batch(folded, wanted[:, :3, 3], locked={folded.joint_names[2]: yaws})
    there = np.where(solutions.found[:, :, None], solutions.q, 0.0).reshape(-1, 4)
    tips = true.poses(there)[:, :3, 3].reshape(*solutions.found.shape, 3)
    miss = np.where(solutions.found, np.linalg.norm(tips - wanted[:, None, :3, 3], axis=2), np.inf).min(axis=1)
    return miss[np.isfinite(miss)] * 1e3, int(np.isfinite(miss).sum())


def _bounds(rows: list[dict[str, Any]]) -> list[Goal]:
    least = [
        ("regular goals not recovered", sum(row["regular"] - row["recovered"] for row in rows), 0.0),
        ("goals without solution", sum(row["lost"] for row in rows), 0.0),
        ("largest residual", max(row["residual"] for row in rows), _RESIDUAL),
        ("solutions that only Newton found", sum(row["missing"] for row in rows), 0.0),
    ]
    for form in dict.fromkeys(row["form"] for row in rows):
        dearest = max((row for row in rows if row["form"] == form), key=lambda row: float(row["cost"]))
        least.append((f"CFJ of {form}, {dearest['goal']}", dearest["cost"], _COSTS.get(form, _OTHER_COST)))
    return [Goal(what, value, bound, at_least=False) for what, value, bound in least]


def _hard_bounds(rows: list[dict[str, Any]]) -> list[Goal]:
    return [
        Goal("hard goals answered wrongly", sum(row["wrong"] for row in rows), 0.0, at_least=False),
        Goal("hard goals with NaN", sum(row["nan"] for row in rows), 0.0, at_least=False),
        Goal("hard goals, largest residual", max(row["residual"] for row in rows), _RESIDUAL, at_least=False),
    ]
