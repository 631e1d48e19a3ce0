"""Which closed form a chain, a target and some locked joints ask for."""

from __future__ import annotations

import itertools
import weakref
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from nao_kin.analytic.certifying import Ranges
from nao_kin.analytic.form import ClosedForm, Geometry, GoalKind, Mismatch, Request
from nao_kin.analytic.forms import FORMS
from nao_kin.errors import InvalidInputError, UnknownNameError
from nao_kin.kernels.joint_path import held

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from numpy.typing import ArrayLike

    from nao_kin.arrays import Floats
    from nao_kin.chain import Chain
    from nao_kin.ik.target import Target

__all__ = ["Matched", "goal_kind", "matched"]


@dataclass(frozen=True, eq=False, slots=True)
class Matched:
    """A closed form that fits a chain, with what is left to do for its kernels.

    Attributes:
        form: The form.
        geometry: The chain as the form reads it, held joints left out.
        kind: What is wanted.
        columns: The chain's columns that the form's rows give.
        given: Values (1, k) or (N, k) of the joints that the form leaves to the caller [rad].
        template: The chain's joints (n,), held ones at their values [rad or m], the others 0.
        ranges: The chain's limits.
    """

    form: ClosedForm
    geometry: Geometry
    kind: GoalKind
    columns: tuple[int, ...]
    given: Floats
    template: Floats
    ranges: Ranges

    @property
    def request(self) -> Request:
        """What the form says about goals of this kind."""
        return self.form.requests[self.kind]


_KNOWN: weakref.WeakKeyDictionary[Chain, dict[GoalKind, Matched]] = weakref.WeakKeyDictionary()


def goal_kind(target: Target) -> GoalKind:
    """What a target wants, as closed forms see it.

    Raises:
        InvalidInputError: Its weights leave an axis free that a closed form does not.
    """
    place, turn = target.counts & 7, target.counts >> 3
    if target.kind == "pointing" and place == 0:
        return "direction"
    whole = {"pose": (7, 7), "position": (7, turn), "pointing": (7, 7), "orientation": (place, 7)}[target.kind]
    if (place, turn) == whole:
        return target.kind
    expected = "every axis of the target to count, or of a pointing target the direction alone"
    raise InvalidInputError("weights", expected, f"{list(target.weights)}; nao_kin.solve takes any weights")


def matched(chain: Chain, target: Target, locked: Mapping[str, Any] | None = None) -> Matched:
    """The form that solves a chain for targets of this kind with some joints locked.

    A locked joint is either one whose value the form leaves to the caller, or it is held and the rest of the chain is
    measured without it.

    Args:
        chain: The chain.
        target: A target that says the kind.
        locked: Values of joints by name [rad or m]; numbers, or arrays (N,) for many targets.

    Raises:
        InvalidInputError: No form fits the chain, or none that fits solves this; the message says what was measured.
        UnknownNameError: A locked joint is not one of the chain; carries near matches.
    """
    if not hasattr(chain, "joint_path"):
        raise InvalidInputError("chain", "a chain, as robot.chain('left_arm') gives one", f"a {type(chain).__name__}")
    kind = goal_kind(target)
    if locked:
        return _match(chain, kind, _locked_values(chain, locked))
    known = _KNOWN.setdefault(chain, {})
    if kind not in known:
        known[kind] = _match(chain, kind, {})
    return known[kind]


def _match(chain: Chain, kind: GoalKind, values: Mapping[int, Floats]) -> Matched:
    for form in sorted(FORMS, key=lambda form: -form.joints):  # so that no joint is held that could be given
        request = form.requests.get(kind)
        if request is None or len(chain.joints) - len(values) + len(request.given) != form.joints:
            continue
        for free in itertools.combinations(sorted(values), len(request.given)):
            fixed = {column: value for column, value in values.items() if column not in free}
            columns = tuple(column for column in range(len(chain.joints)) if column not in fixed)
            if tuple(columns[i] for i in request.given) != free:
                continue
            geometry = _measured(chain, form, _numbers(chain, fixed))
            if isinstance(geometry, Geometry):
                template = np.zeros(len(chain.joints))
                template[list(fixed)] = [float(value) for value in fixed.values()]
                given = _given([values[c] for c in free])
                return Matched(form, geometry, kind, columns, given, template, Ranges.of(chain))
    raise _refusal(chain, kind, values)


def _locked_values(chain: Chain, locked: Mapping[str, ArrayLike]) -> dict[int, Floats]:
    """Locked values by column, each a number or an array (N,)."""
    found = {}
    for name, value in locked.items():
        if name not in chain.joint_names:
            raise UnknownNameError("joint", name, chain.joint_names, chain.name)
        try:
            array = np.asarray(value, dtype=np.float64)
        except (TypeError, ValueError):
            raise InvalidInputError(f"locked {name}", "a number [rad or m]", repr(value)[:60]) from None
        if array.ndim > 1 or not np.isfinite(array).all():
            raise InvalidInputError(f"locked {name}", "finite numbers [rad or m]", repr(value)[:60])
        found[chain.joint_names.index(name)] = array
    return found


def _numbers(chain: Chain, fixed: Mapping[int, Floats]) -> dict[int, float]:
    for column, value in fixed.items():
        if value.ndim:
            what = f"locked {chain.joint_names[column]}"
            raise InvalidInputError(what, "one number for all targets, as the joint is held", f"shape {value.shape}")
    return {column: float(value) for column, value in fixed.items()}


def _measured(chain: Chain, form: ClosedForm, fixed: Mapping[int, float]) -> Geometry | Mismatch:
    if len(fixed) == len(chain.joints):
        return Mismatch("all its joints are locked")
    path = chain.joint_path
    return form.recognise(held(path, fixed) if fixed else path)


def _given(values: Iterable[Floats]) -> Floats:
    columns = np.broadcast_arrays(*(np.atleast_1d(value) for value in values)) or [np.zeros(1)]
    return np.ascontiguousarray(np.stack(columns, axis=1), dtype=np.float64)


def _refusal(chain: Chain, kind: GoalKind, values: Mapping[int, Floats]) -> InvalidInputError:
    """Says what the chain can be asked, if a form fits it as it is or with all locked joints held; else, why none."""
    names, reasons = chain.joint_names, []
    for fixed in ({}, values) if values else ({},):
        columns = [column for column in range(len(names)) if column not in fixed]
        for form in (form for form in FORMS if form.joints == len(columns)):
            geometry = _measured(chain, form, {column: float(np.ravel(v)[0]) for column, v in fixed.items()})
            if isinstance(geometry, Mismatch):
                reasons.append(f"as {form.name}, {geometry.reason}")
                continue
            offers = ", ".join(_offer(k, request, [names[c] for c in columns]) for k, request in form.requests.items())
            locked = ", ".join(names[column] for column in values) or "nothing"
            got = f"{'an' if kind == 'orientation' else 'a'} {kind} with {locked} locked"
            got += f" ({'; '.join(reasons)})" if reasons else ""
            return InvalidInputError("target", f"what {form.name} solves: {offers}", got)
    counts = sorted({form.joints for form in FORMS})
    reasons = reasons or [f"{len(names)} joints where the closed forms have {', '.join(map(str, counts))}"]
    got = f"another: {'; '.join(reasons)}. nao_kin.solve takes any chain"
    return InvalidInputError(chain.name, "the geometry of a closed form", got)


def _offer(kind: GoalKind, request: Request, names: list[str]) -> str:
    if not request.given:
        return kind
    return f"{kind} with {' and '.join(names[i] for i in request.given)} locked"
