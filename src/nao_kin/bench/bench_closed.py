"""`nao-kin bench closed`: every closed form against random joints, Newton, singular goals and Pinocchio's clock."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, Final

import numpy as np
import typer

from nao_kin.analytic.form import GoalKind
from nao_kin.analytic.forms import FORMS
from nao_kin.analytic.matching import Matched, matched
from nao_kin.analytic.nao import nao_arm, nao_head
from nao_kin.bench.sheet import GoalsOption, Heading, Machine, Promise, Sheet, conclude
from nao_kin.chain import random_configurations
from nao_kin.errors import InvalidInputError
from nao_kin.ik.target import Target
from nao_kin.output import FormatOption, OutputFormat, progress

if TYPE_CHECKING:
    from collections.abc import Iterator

    from nao_kin.analytic.solution_batch import BatchSolutions
    from nao_kin.arrays import Floats
    from nao_kin.robot.urdf_chain import UrdfChain

__all__ = ["FormCase", "cases", "closed", "found_by", "strata", "unreachable"]

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

    from nao_kin.bench.bench_closed import cases

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


def _recovery(case: FormCase) -> dict[str, Any]:
    """Whether the joints that made each goal are among its solutions, and how exact all solutions are."""
    import numpy as np

    from nao_kin.bench.all_solutions import least_singular_value
    from nao_kin.bench.bench_closed import found_by

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


def _completeness(case: FormCase, count: int, starts: int, rng: np.random.Generator) -> dict[str, Any]:
    """How many solutions Newton finds, and how many of them are not among the closed form's."""
    from dataclasses import replace

    import numpy as np

    from nao_kin.bench.all_solutions import apart, least_singular_value, multi_start
    from nao_kin.bench.bench_closed import found_by

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


def _cost(case: FormCase, rounds: int) -> dict[str, float]:
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


def _hard(case: FormCase, count: int, rng: np.random.Generator) -> list[dict[str, Any]]:
    """Goals at limits, singularities and the border: all have a solution; goals just beyond: none has."""
    from nao_kin.bench.bench_closed import strata, unreachable

    rows = [_hard_row(hard, stratum, count) for stratum, hard in strata(case, count, rng)]
    if (missed := unreachable(case, count, rng)) is not None:
        rows.append(_hard_row(missed, "3 µm beyond", 0))
    return rows


def _hard_row(case: FormCase, stratum: str, wanted: int) -> dict[str, Any]:
    import numpy as np

    from nao_kin.bench.bench_closed import found_by

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


def _bounds(rows: list[dict[str, Any]]) -> list[Promise]:
    least = [
        ("regular goals not recovered", sum(row["regular"] - row["recovered"] for row in rows), 0.0),
        ("goals without solution", sum(row["lost"] for row in rows), 0.0),
        ("largest residual", max(row["residual"] for row in rows), _RESIDUAL),
        ("solutions that only Newton found", sum(row["missing"] for row in rows), 0.0),
    ]
    for form in dict.fromkeys(row["form"] for row in rows):
        dearest = max((row for row in rows if row["form"] == form), key=lambda row: float(row["cost"]))
        least.append((f"CFJ of {form}, {dearest['goal']}", dearest["cost"], _COSTS.get(form, _OTHER_COST)))
    return [Promise(what, value, bound, at_least=False) for what, value, bound in least]


def _hard_bounds(rows: list[dict[str, Any]]) -> list[Promise]:
    return [
        Promise("hard goals answered wrongly", sum(row["wrong"] for row in rows), 0.0, at_least=False),
        Promise("hard goals with NaN", sum(row["nan"] for row in rows), 0.0, at_least=False),
        Promise("hard goals, largest residual", max(row["residual"] for row in rows), _RESIDUAL, at_least=False),
    ]


_CHAINS: Final = (
    ("nao", "torso", "CameraTop_frame"),
    ("nao", "torso", "CameraBottom_frame"),
    ("nao", "torso", "LArm"),
    ("nao", "torso", "RArm"),
    ("nao_v32_h25", "torso", "LArm"),
    ("nao_v50_h21", "torso", "LArm"),
    ("nao_v50_h21", "torso", "RArm"),
    ("nao", "torso", "LLeg"),
    ("nao", "torso", "RLeg"),
    ("phantomx", "base_link", "foot_lf"),
)
_FREE: Final = {"x": 0.0, "y": 0.0, "z": 0.0}
_NEAR: Final = tuple(10.0**-k for k in range(3, 13))
_BEYOND: Final = 3e-6  # [m]: three times what counts as reached


@dataclass(frozen=True, eq=False)
class FormCase:
    """Goals of one kind for one chain.

    Attributes:
        chain: The chain.
        found: Its closed form.
        Q: Joints (N, n) that the goals were made of [rad].
        goals: The goals (N, 4, 4), see `nao_kin.ik.target.Target`.
    """

    chain: UrdfChain
    found: Matched
    Q: Floats
    goals: Floats

    @property
    def given(self) -> tuple[int, ...]:
        """Columns of the joints that are given with a goal."""
        return tuple(self.found.columns[i] for i in self.found.request.given)

    @property
    def locked(self) -> Floats:
        """Values of the joints that are given (N, n), NaN for the others."""
        locked = np.full(self.Q.shape, np.nan)
        locked[:, self.given] = self.Q[:, self.given]
        return locked

    @property
    def name(self) -> str:
        """Robot and tip."""
        return f"{self.chain.robot.name} {self.chain.tip}"


def cases(count: int, rng: np.random.Generator) -> Iterator[FormCase]:
    """Every kind of goal that a closed form of a bundled robot takes, at random joints within the limits."""
    from nao_kin.robot.robot import load

    kinds = list(dict.fromkeys(kind for form in FORMS for kind in form.requests))
    for robot, base, tip in _CHAINS:
        chain = load(robot).chain(base, tip)
        Q = random_configurations(chain, count, rng)
        for kind in kinds:
            if (found := _form_of(chain, kind)) is not None:
                yield FormCase(chain, found, Q, _goals(kind, chain.poses(Q), rng))


def found_by(case: FormCase) -> BatchSolutions:
    """What the package answers."""
    from nao_kin.analytic.solution_batch import solve_all_batch

    names = case.chain.joint_names
    targets = [_target(case.found.kind, goal) for goal in case.goals]
    return solve_all_batch(case.chain, targets, locked={names[i]: case.Q[:, i] for i in case.given})


def strata(case: FormCase, count: int, rng: np.random.Generator) -> Iterator[tuple[str, FormCase]]:
    """The same kind of goals at joint limits, at and near singularities, at the border; by Pinocchio's kinematics."""
    ends = np.array([case.chain.lower, case.chain.upper])
    Q = random_configurations(case.chain, count, rng)
    at_ends = rng.integers(0, 3, Q.shape)
    yield "joints at limits", _again(case, np.where(at_ends < 2, np.where(at_ends == 0, *ends), Q), rng)
    singular = _singular(case)
    for what, values in singular.items():
        exact = Q.copy()
        exact[:, list(values)] = list(values.values())
        yield f"{what}, exactly", _again(case, exact, rng)
        near = exact.copy()
        near[:, list(values)] += rng.choice(_NEAR, (count, 1)) * rng.choice((-1.0, 1.0), (count, len(values)))
        yield f"{what}, off by 1e-3 to 1e-12", _again(case, near, rng)
    if case.found.kind == "position" and case.found.form.name.startswith("nao_arm"):
        yield "border of the reach", _again(case, _stretched(case, Q), rng)
    if case.found.kind == "pointing":
        yield "line through the shoulder, exactly", _through_shoulder(case, Q, np.zeros((count, 3)))
        off = rng.choice(_NEAR, (count, 1)) * rng.normal(size=(count, 3))
        yield "line through the shoulder, off by 1e-3 to 1e-12", _through_shoulder(case, Q, off)


def unreachable(case: FormCase, count: int, rng: np.random.Generator) -> FormCase | None:
    """Goals of an arm that miss what it reaches by three micrometres, or None of another chain."""
    if not case.found.form.name.startswith("nao_arm") or case.found.kind == "pointing":
        return None
    numbers, Q = case.found.geometry.parameters, random_configurations(case.chain, count, rng)
    Q = _stretched(case, Q) if case.found.kind == "position" else Q
    missed = _again(case, Q, rng)
    from_shoulder = missed.goals[:, :3, 3] - numbers[nao_arm.SHOULDER : nao_arm.LENGTH]
    if case.found.kind == "pose":  # the elbow point is moved away from the shoulder, which its upper arm forbids
        T = missed.goals[:, :3, :3] @ numbers[nao_arm.HAND : nao_arm.TIP].reshape(3, 3).T
        from_shoulder -= np.einsum("nij,j->ni", T, numbers[nao_arm.TIP : nao_arm.TIP + 3])
    outwards = from_shoulder / np.linalg.norm(from_shoulder, axis=1, keepdims=True)
    missed.goals[:, :3, 3] += _BEYOND * outwards
    return missed


def _form_of(chain: UrdfChain, kind: GoalKind) -> Matched | None:
    """The chain's own closed form for a kind of goal, with what it leaves free given; None if there is none."""
    for form in (form for form in FORMS if form.joints == len(chain.joints) and kind in form.requests):
        given = {chain.joint_names[i]: 0.0 for i in form.requests[kind].given}
        try:
            return matched(chain, _target(kind, np.eye(4) if kind in ("pose", "orientation") else _AHEAD), given)
        except InvalidInputError:
            continue
    return None


_AHEAD: Final = np.array([[1.0, 1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])


def _target(kind: GoalKind, goal: Floats) -> Target:
    if kind == "direction":
        return Target.pointing(goal[:3, 3], goal[:3, 1], goal[:3, 0], weights=_FREE)
    return Target(kind, np.ascontiguousarray(goal))


def _goals(kind: GoalKind, tips: Floats, rng: np.random.Generator) -> Floats:
    """Goals that these tips reach; a pointing axis is a random one of the tip."""
    goals = tips.copy()
    if kind in ("pointing", "direction"):
        axes = rng.normal(size=(len(tips), 3))
        axes /= np.linalg.norm(axes, axis=1, keepdims=True)
        goals[:, :3, 0], goals[:, :3, 2] = axes, 0.0
        goals[:, :3, 1] = np.einsum("nij,nj->ni", tips[:, :3, :3], axes)
    return goals


def _again(case: FormCase, Q: Floats, rng: np.random.Generator) -> FormCase:
    tips = np.array([case.chain.pose(q).homogeneous for q in Q])
    return FormCase(case.chain, case.found, Q, _goals(case.found.kind, tips, rng))


def _through_shoulder(case: FormCase, Q: Floats, off: Floats) -> FormCase:
    """Pointing goals whose line passes the shoulder at about some distance (N, 3) [m]: the arm may turn about it."""
    numbers, goals = case.found.geometry.parameters, np.array([case.chain.pose(q).homogeneous for q in Q])
    lines = goals[:, :3, 3] - numbers[nao_arm.SHOULDER : nao_arm.LENGTH] + off
    lines /= np.linalg.norm(lines, axis=1, keepdims=True)
    axes = np.einsum("nji,nj->ni", goals[:, :3, :3], lines)
    goals[:, :3, 0], goals[:, :3, 1], goals[:, :3, 2] = axes, lines, 0.0
    return FormCase(case.chain, case.found, Q, goals)


def _singular(case: FormCase) -> dict[str, dict[int, float]]:
    """Joint values at which a form is singular, by column."""
    numbers = case.found.geometry.parameters
    if case.found.form.name == "nao_head":
        t = numbers[nao_head.TIP :]
        return {"camera above the neck": {1: math.atan2(-t[0], t[2])}}
    if case.found.form.name.startswith("nao_arm"):
        bend = math.atan2(numbers[nao_arm.OFFSET], numbers[nao_arm.LENGTH])
        shifts = numbers[nao_arm.SHIFTS :]
        elbow, shoulder = {3: -shifts[3]}, {1: 0.5 * math.pi - bend - shifts[1]}
        return {"elbow straight": elbow, "elbow on the pitch axis": shoulder, "both": elbow | shoulder}
    return {}


def _stretched(case: FormCase, Q: Floats) -> Floats:
    """The same joints with the elbow roll at which the tip is farthest from the shoulder."""
    p, stretched = case.found.geometry.parameters, Q.copy()
    L, o, (x, y, z) = p[nao_arm.LENGTH], p[nao_arm.OFFSET], p[nao_arm.TIP : nao_arm.TIP + 3]
    turn = Q[:, 4] if Q.shape[1] == 5 else np.zeros(len(Q))
    beside, yaw = np.cos(turn) * y - np.sin(turn) * z, np.cos(Q[:, 2] + p[nao_arm.SHIFTS + 2])
    stretched[:, 3] = np.arctan2(o * yaw * x - L * beside, L * x + o * yaw * beside) - p[nao_arm.SHIFTS + 3]
    return stretched
