"""What thesis and practicum say of the methods, each claim held against what was measured in the same run.

What the thesis says is judged by the rules of `nao_kin.documents.thesis.methods_compared`, as the ledger's small
samples are; here cost is time, and targets are many.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from nao_kin.documents.thesis import methods_compared as said

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from nao_kin.bench.closed_beside import Beside
    from nao_kin.bench.method_sets import Outcome, TargetSet

__all__ = ["Figures", "claims"]

DAMPED = ("dls", "dls_adaptive", "sdls", "lm")


@dataclass(frozen=True, eq=False, slots=True)
class Figures:
    """The outcomes by what they are about, for claims to look up.

    Attributes:
        near: Near targets, one start.
        alone: Full range, one start.
        restarts: Full range, with restarts.
        hard: Edge of reach and singularity, one start.
        beside: Closed forms beside all methods, in batches.
    """

    near: Sequence[Outcome]
    alone: Sequence[Outcome]
    restarts: Sequence[Outcome]
    hard: Sequence[Outcome]
    beside: Sequence[Beside]


def claims(figures: Figures) -> list[str]:
    """A sentence a claim: where it stands, what it says, confirmed or refuted, and by how much."""
    told = []
    for place, text, check in _CLAIMS:
        holds, figure = check(figures)
        told += ["", f"{place}: “{text}”: {'confirmed' if holds else 'refuted'}. {figure}"]
    return told


def _pick(outcomes: Iterable[Outcome], method: str, kind: str) -> Outcome:
    return next(o for o in outcomes if o.method == method and o.of.kind == kind)


def _those(outcomes: Iterable[Outcome], methods: Sequence[str], kind: str) -> list[Outcome]:
    return [o for o in outcomes if o.method in methods and o.of.kind == kind]


def _micro(outcome: Outcome) -> float:
    return outcome.median_seconds * 1e6


def _cost(outcomes: Iterable[Outcome], methods: Sequence[str]) -> dict[str, float]:
    """Median times [µs] on positions of the NAO arm."""
    return {o.method: _micro(o) for o in _those(outcomes, methods, "position")}


def _closed_is_fastest(f: Figures) -> tuple[bool, str]:
    """Thesis 3.5."""
    from nao_kin.bench.closed_beside import CLOSED

    told, ahead = [], list[str]()
    for beside in f.beside:
        others = {name: micro for name, micro in beside.micro.items() if name != CLOSED}
        quickest = min(others, key=others.__getitem__)
        ahead += [quickest] if others[quickest] < beside.micro[CLOSED] else []
        ours = f"{beside.what} {beside.micro[CLOSED]:.1f} µs with every branch"
        told.append(f"{ours}, {quickest} {others[quickest]:.1f} µs for one")
    return not ahead, f"A target in a batch on one thread, judged: {'; '.join(told)}."


def _closed_is_stable(f: Figures) -> tuple[bool, str]:
    """Thesis 3.5."""
    from nao_kin.bench.closed_beside import CLOSED

    told = ", ".join(f"{beside.what} {beside.success[CLOSED]:.1f} %" for beside in f.beside)
    return all(beside.success[CLOSED] == 100.0 for beside in f.beside), (
        f"Solved within limits: {told}. nao-kin bench closed says the same of singular poses and the border."
    )


def _fabrik_is_fastest(f: Figures) -> tuple[bool, str]:
    """Thesis 3.5."""
    cost = _cost(f.restarts, said.ITERATIVE)
    before, least = said.cheaper(cost, "fabrik"), min(cost, key=cost.__getitem__)
    return not before, (
        f"On the NAO arm {least} takes {cost[least]:.0f} µs in the median and fabrik "
        f"{cost['fabrik']:.0f} µs, place {len(before) + 1} of {len(cost)}."
    )


def _thousand_times(f: Figures) -> tuple[bool, str]:
    """Thesis 3.5, quoting Aristidou and Lasenby."""
    cost = _cost(f.restarts, said.ITERATIVE)
    ratios = {name: cost[name] / cost["fabrik"] for name in said.JACOBIAN}
    slowest, quickest = max(ratios, key=ratios.__getitem__), min(ratios, key=ratios.__getitem__)
    return not said.not_so_much_dearer(cost, "fabrik", said.ratio()), (
        f"Against fabrik on the NAO arm they take from {ratios[quickest]:.2f} ({quickest}) to {ratios[slowest]:.2f} "
        f"({slowest}) times as long."
    )


def _many_iterations(f: Figures) -> tuple[bool, str]:
    """Thesis 3.5."""
    every = {o.method: o.median_iterations for o in _those(f.near, said.ITERATIVE, "position")}
    counts = {name: every[name] for name in said.JACOBIAN}
    fewer = [name for name in said.cheaper(every, "fabrik") if name in counts]
    return not fewer, (
        f"Near targets take fabrik {every['fabrik']:.0f} iterations, {min(counts, key=counts.__getitem__)} "
        f"{min(counts.values()):.0f} and {max(counts, key=counts.__getitem__)} {max(counts.values()):.0f}; "
        f"{len(fewer)} of {len(counts)} need fewer than fabrik."
    )


def _unstable_inverses(f: Figures) -> tuple[bool, str]:
    """Thesis 3.5 and practicum 1.7."""
    pinv, damped = _pick(f.hard, "pinv", "pose"), _those(f.hard, DAMPED, "pose")
    calm = max(o.wild_move for o in damped)
    return pinv.wild_move > 2.0 * calm, (
        f"At singular poses one start in twenty ends more than {pinv.wild_move:.2f} rad away in some joint with pinv, "
        f"and at most {calm:.2f} rad with any damped method; the solution is 0.2 rad away. They reach "
        f"{pinv.success:.0f} % and {min(o.success for o in damped):.0f} to {max(o.success for o in damped):.0f} %."
    )


def _edge_for_fabrik(f: Figures) -> tuple[bool, str]:
    """Thesis 3.4 and 3.5: no singularities, robust."""
    fabrik, lm = _pick(f.hard, "fabrik", "position"), _pick(f.hard, "lm", "position")
    return fabrik.success >= lm.success, (
        f"At 99.9 % of the NAO arm's reach fabrik reaches {fabrik.success:.0f} % from one start, lm {lm.success:.0f} %."
    )


def _natural(f: Figures) -> tuple[bool, str]:
    """Thesis 3.4: the pose looks natural; measured as how far the joints go from where they were."""
    moves = {o.method: o.largest_move for o in _those(f.alone, said.ITERATIVE, "position")}
    least = min(moves, key=moves.__getitem__)
    return said.extra_move(moves, "fabrik") <= 0.1, (
        f"If natural means that joints move little: fabrik's largest joint moves by {moves['fabrik']:.2f} rad in "
        f"the median, {least}'s by {moves[least]:.2f}."
    )


def _at_least_equal(f: Figures) -> tuple[bool, str]:
    """Thesis 4.1."""
    fabrik = _pick(f.alone, "fabrik", "position")
    reached = {o.method: o.success for o in _those(f.alone, said.ITERATIVE, "position")}
    ahead = said.as_good_and_cheaper(reached, _cost(f.alone, said.ITERATIVE), "fabrik")
    return not ahead, (
        f"From one start fabrik reaches {fabrik.success:.0f} % in {_micro(fabrik):.0f} µs; as good and quicker are "
        f"{', '.join(ahead) or 'none'}. It does positions only, on chains of hinges only."
    )


def _inferior(f: Figures) -> tuple[bool, str]:
    """Thesis 4.2: FTL and CCD are variations of the others or inferior to them."""
    found = {name: _pick(f.alone, name, "position") for name in (*said.SHOWN, "ftl", "ccd")}
    of = len(found["fabrik"].solved)
    better, more = said.clearly_better({name: float(o.solved.sum()) for name, o in found.items()}, of)
    chance = 100.0 * more / of
    told = ", ".join(f"{name} {o.success:.0f} % in {_micro(o):.0f} µs" for name, o in found.items())
    return not better, f"From one start on the NAO arm: {told}; up to {chance:.0f} % would be chance."


def _small_gain(f: Figures) -> tuple[bool, str]:
    """Practicum 1.4."""
    from nao_kin.bench.method_sets import LONG, run

    of = _pick(f.alone, "newton", "pose").of
    outcomes = {K: run(of, "newton", LONG, {"gain": K}) for K in (1.0, 0.5, 0.1)}
    told = ", ".join(f"K = {K:g}: {o.success:.0f} % in {o.median_iterations:.0f}" for K, o in outcomes.items())
    return outcomes[0.1].success > outcomes[1.0].success, f"Newton on the JACO2 from one start, iterations: {told}."


def _transpose_nearby(f: Figures) -> tuple[bool, str]:
    """Practicum 1.6: accurate enough at small distances, measured as what is left of the way after ten steps."""
    of = _pick(f.near, "transpose", "position").of
    left = {distance: _left_after(of, distance, 10) for distance in (0.05, 0.001)}
    return left[0.001] < 0.5 * left[0.05], (
        f"After ten steps {100.0 * left[0.05]:.0f} % of 5 cm are left, and {100.0 * left[0.001]:.0f} % of 1 mm. "
        "Confirmed would be a share at 1 mm that is less than half of the other."
    )


def _left_after(of: TargetSet, distance: float, steps: int) -> float:
    """Median share of the distance to a position that the transpose leaves."""
    import nao_kin as nk

    rng, shares, budget = (
        np.random.default_rng(0),
        list[float](),
        nk.Budget(iterations=steps, restarts=0, patience=steps),
    )
    for q in of.starts:
        d = rng.normal(size=3)
        wanted = of.chain.pose(q).translation + d * (distance / np.linalg.norm(d))
        result = nk.solve(of.chain, wanted, q, method="transpose", budget=budget)
        shares.append((result.position_error or 0.0) / distance)
    return float(np.median(shares))


def _fewer_steps(f: Figures) -> tuple[bool, str]:
    """Practicum 1.8."""
    names = ("combination", "pinv", "transpose")
    found = {name: _pick(f.alone, name, "pose") for name in names}
    told = ", ".join(f"{name} {o.median_iterations:.0f} ({o.success:.0f} %)" for name, o in found.items())
    most = min(found["pinv"].median_iterations, found["transpose"].median_iterations)
    return found["combination"].median_iterations < most, f"Iterations on the JACO2 over the full range: {told}."


def _suppressed(f: Figures) -> tuple[bool, str]:
    """Practicum 1.8."""
    combination, pinv = _pick(f.hard, "combination", "pose"), _pick(f.hard, "pinv", "pose")
    return combination.wild_move < 0.5 * pinv.wild_move, (
        f"At singular poses one start in twenty ends more than {combination.wild_move:.2f} rad away in some joint with "
        f"the combination and {pinv.wild_move:.2f} rad with pinv; they reach {combination.success:.0f} and "
        f"{pinv.success:.0f} %."
    )


def _small_cost(f: Figures) -> tuple[bool, str]:
    """Practicum 1.8."""

    def cost(name: str) -> float:
        outcome = _pick(f.alone, name, "pose")
        return 1e6 * float(outcome.seconds.sum()) / max(1, int(outcome.iterations.sum()))

    both, one = cost("combination"), cost("pinv")
    return both < 1.25 * one, (
        f"An iteration takes {both:.2f} µs with both and {one:.2f} µs with pinv alone: choosing takes a forward "
        "kinematics for each."
    )


def _single_starts(f: Figures) -> tuple[bool, str]:
    """Practicum 1.4: local minima, so the start matters and interpolating helps."""
    near, far = _pick(f.near, "lm", "pose"), _pick(f.alone, "lm", "pose")
    return near.success > far.success, (
        f"lm from one start reaches {near.success:.0f} % of the targets within 0.2 rad and {far.success:.0f} % of "
        "those anywhere."
    )


_CLAIMS: tuple[tuple[str, str, Callable[[Figures], tuple[bool, str]]], ...] = (
    ("Thesis 3.4", "robust, no singularities during the iteration of FABRIK", _edge_for_fabrik),
    ("Thesis 3.4", "FABRIK's pose looks natural", _natural),
    ("Thesis 3.5", "the analytic solution takes the least computing time", _closed_is_fastest),
    ("Thesis 3.5", "the analytic solution is very stable", _closed_is_stable),
    ("Thesis 3.5", "FABRIK is the fastest iterative method", _fabrik_is_fastest),
    ("Thesis 3.5", "Jacobian methods take 1000 times longer", _thousand_times),
    ("Thesis 3.5", "because of their many iterations", _many_iterations),
    ("Thesis 3.5", "inverses are unstable near singularities", _unstable_inverses),
    ("Thesis 4.1", "FABRIK is at least equal to the Jacobian methods", _at_least_equal),
    ("Thesis 4.2", "follow-the-leader and CCD are inferior or variations", _inferior),
    ("Practicum 1.4", "the start decides between local and global minimum", _single_starts),
    ("Practicum 1.4", "a small K converges more surely, in more steps", _small_gain),
    ("Practicum 1.6", "the transpose is accurate for small distances", _transpose_nearby),
    ("Practicum 1.8", "the combination needs fewer steps", _fewer_steps),
    ("Practicum 1.8", "it suppresses the instabilities of the pseudo-inverse", _suppressed),
    ("Practicum 1.8", "a step of it costs little more", _small_cost),
)
