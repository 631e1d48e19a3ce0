"""The table of methods: what each is, where it comes from, what it can do and when to choose it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Final, Literal

from nao_kin.arrays import positive
from nao_kin.errors import InvalidInputError, UnknownNameError
from nao_kin.ik import rules
from nao_kin.ik.geometric.sweep import CCD, FABRIK, FOLLOW_THE_LEADER, refusal
from nao_kin.ik.orientation import EULER, QUATERNION, ROTATION_VECTOR
from nao_kin.ik.reference_loop import Budget
from nao_kin.ik.target import AXES

if TYPE_CHECKING:
    from nao_kin.chain import Chain
    from nao_kin.ik.scales import Scales
    from nao_kin.ik.target import Target, TargetKind

__all__ = ["METHODS", "Method", "Parameter", "method_named"]


@dataclass(frozen=True, slots=True)
class Parameter:
    """A number that a method can be tuned with.

    Attributes:
        name: What `solve(..., parameters={name: value})` takes.
        factor: The default, in units of `per`.
        per: What the default is measured by: ``""`` for a plain number, or a scale of the chain over its stored
            configurations: ``"σ"`` the largest singular value, ``"1/σ²"``, or ``"w"`` the largest manipulability.
        meaning: What it is.
    """

    name: str
    factor: float
    per: Literal["", "σ", "1/σ²", "w"]
    meaning: str

    def default(self, scales: Scales | None) -> float:
        """The default for a chain of these scales; those without a scale need none.

        Of a chain whose joints do not move what the target binds, any will do: its Jacobian is 0.
        """
        sigma = 0.0 if scales is None else scales.singular_value
        if not self.per or scales is None or sigma * sigma == 0.0:
            return self.factor
        return self.factor * {"σ": sigma, "1/σ²": 1.0 / (sigma * sigma), "w": scales.manipulability}[self.per]


@dataclass(frozen=True, slots=True)
class Method:
    """One row of the table of methods.

    Attributes:
        name: What `solve` takes.
        code: The number of the update rule, see `nao_kin.ik.rules`, or of the sweep, see `nao_kin.ik.geometric.sweep`;
            −1 for none.
        targets: Kinds of target it handles.
        parameters: What it can be tuned with, in the rule's order.
        reference: Where it comes from.
        choose_it: When to.
        orientation_error: Form of the orientation error it sees, see `nao_kin.ik.orientation`.
        weighs: Number of axes, in the order of `nao_kin.ik.target.AXES`, that may have weights other than 1.
        hinges: Whether it works on chains of hinges with a motor each only.
        kind: ``"iteration"``, or ``"closed form"`` for what is computed at once and needs a fitting chain.
        several_tips: Whether it serves several tips at once, see `nao_kin.solve_tree`.
        budget: How long it tries unless told otherwise; slow methods need more patience.
    """

    name: str
    code: int
    targets: tuple[TargetKind, ...]
    parameters: tuple[Parameter, ...]
    reference: str
    choose_it: str
    orientation_error: int = ROTATION_VECTOR
    weighs: int = 6
    hinges: bool = False
    kind: Literal["iteration", "closed form"] = "iteration"
    several_tips: bool = True
    budget: Budget = field(default_factory=Budget)

    @property
    def scaled(self) -> bool:
        """Whether a default depends on the chain."""
        return any(parameter.per for parameter in self.parameters)

    def refusal(self, chain: Chain, target: Target) -> InvalidInputError | None:
        """Why its iteration cannot do a target on a chain, as an error that names the remedy; None if it can."""
        if self.kind == "closed form":
            return InvalidInputError("method", "one that iterates", f"{self.name!r}, which has no steps")
        if target.kind not in self.targets:
            expected = f"a {' or '.join(self.targets)} target, which is all that method {self.name!r} handles"
            return InvalidInputError("target", expected, f"a {target.kind} target")
        if set(target.weights[self.weighs :]) - {1.0}:
            expected = f"weights of 1 for {', '.join(AXES[self.weighs :])}, as method {self.name!r} weighs them alike"
            return InvalidInputError("weights", expected, str(list(target.weights)))
        if self.hinges and (reason := refusal(chain.joint_path)):
            expected = f"a chain of hinges for method {self.name!r}; 'lm' works on any, for one tip 'ccd' too"
            return InvalidInputError(f"chain {chain.name}", expected, f"one that is not: {reason}")
        return None

    def tuned(self, given: Mapping[str, float], scales: Scales | None) -> tuple[float, ...]:
        """The parameters in the rule's order, defaults for those not given.

        Raises:
            UnknownNameError: The method has no such parameter; carries near matches.
            InvalidInputError: Not a mapping, or a value is not a finite number above 0.
        """
        if not isinstance(given, Mapping):
            raise InvalidInputError("parameters", "numbers by name, as {'gain': 0.5}", repr(given)[:60])
        names = [parameter.name for parameter in self.parameters]
        for name in given:
            if name not in names:
                raise UnknownNameError("parameter", name, names, f"method {self.name!r}")
        values = {name: positive(value, f"parameter {name}") for name, value in given.items()}
        return tuple(values[p.name] if p.name in values else p.default(scales) for p in self.parameters)


_ALL: Final[tuple[TargetKind, ...]] = ("pose", "position", "pointing", "orientation")
_TURNED: Final[tuple[TargetKind, ...]] = ("pose", "orientation")
_GAIN: Final = Parameter("gain", 1.0, "", "K, scales every step")
_SLOW: Final = Budget(iterations=5000, patience=1000)
_STEADY: Final = Budget(iterations=1000, patience=50)

_ROWS: Final = (
    Method(
        name="lm",
        code=rules.LEVENBERG_MARQUARDT,
        targets=_ALL,
        # Smaller than the source's: steps are bounded otherwise, and less damping converges sooner.
        parameters=(_GAIN, Parameter("damping", 0.05, "", "λ² per squared error")),
        reference="Chan and Lawrence 1988, error-damped least squares",
        choose_it="by default: quadratic convergence near the target, bounded steps at singularities",
    ),
    Method(
        name="transpose",
        code=rules.TRANSPOSE,
        targets=_ALL,
        parameters=(Parameter("gain", 1.5, "1/σ²", "K, fixed; below 2/σ² the linear error cannot grow"),),
        reference="practicum (14); Bischoff 2016, (3.2.1.1)",
        choose_it="to see the simplest method there is; it needs thousands of steps",
        budget=_SLOW,
    ),
    Method(
        name="transpose_buss",
        code=rules.TRANSPOSE_BUSS,
        targets=_ALL,
        # The full step is the best one along its direction, yet a little less saves most of the zigzag that follows.
        parameters=(Parameter("gain", 0.9, "", "K, part of the step that makes the linear error least"),),
        reference="Bischoff 2016, (3.2.1.2); Buss 2004",
        choose_it="the transpose without a gain to find: its own step length at every step",
        budget=_SLOW,
    ),
    Method(
        name="pinv",
        code=rules.PSEUDO_INVERSE,
        targets=_ALL,
        parameters=(_GAIN,),
        reference="practicum (16); Bischoff 2016, (3.2.2.1)",
        choose_it="far from singularities; near them its steps are huge",
        budget=Budget(patience=20),
    ),
    Method(
        name="combination",
        code=rules.COMBINATION,
        targets=_ALL,
        parameters=(_GAIN, Parameter("transpose_gain", 1.5, "1/σ²", "K of the transpose")),
        reference="practicum, section 1.8",
        choose_it="to repeat the practicum: the better of pseudo-inverse and transpose at every step",
        several_tips=False,
        budget=_STEADY,
    ),
    Method(
        name="newton",
        code=rules.NEWTON,
        targets=_ALL,
        parameters=(_GAIN,),
        reference="practicum (12), (13), (15), with the rotation vector as error",
        choose_it="to see Newton's method without any damping",
        budget=Budget(patience=20),
    ),
    Method(
        name="newton_euler",
        code=rules.NEWTON,
        targets=_TURNED,
        parameters=(_GAIN,),
        reference="practicum (5), (12)",
        choose_it="to repeat the practicum: differences of roll, pitch and yaw; fails at pitch ±90°",
        orientation_error=EULER,
        weighs=3,
        several_tips=False,
        budget=Budget(patience=20),
    ),
    Method(
        name="newton_quaternion",
        code=rules.NEWTON,
        targets=_TURNED,
        parameters=(_GAIN,),
        reference="practicum (8), (12)",
        choose_it="to repeat the practicum: vector part of the quaternion; fails at half a turn",
        orientation_error=QUATERNION,
        weighs=3,
        several_tips=False,
        budget=Budget(patience=20),
    ),
    Method(
        name="dls",
        code=rules.DAMPED,
        targets=_ALL,
        parameters=(_GAIN, Parameter("damping", 0.005, "σ", "λ, fixed")),
        reference="Wampler 1986, damped least squares",
        choose_it="to follow moving targets calmly, one step a sample",
        budget=_STEADY,
    ),
    Method(
        name="dls_adaptive",
        code=rules.DAMPED_ADAPTIVE,
        targets=_ALL,
        parameters=(
            _GAIN,
            Parameter("damping", 0.005, "σ", "λ at a singularity"),
            Parameter("threshold", 0.05, "w", "manipulability below which λ sets in"),
        ),
        reference="Nakamura and Hanafusa 1986",
        choose_it="Newton's speed where the arm is regular, damping where it is not",
        budget=_STEADY,
    ),
    Method(
        name="sdls",
        code=rules.SELECTIVELY_DAMPED,
        targets=_ALL,
        parameters=(_GAIN, Parameter("largest_step", math.pi / 4.0, "", "γ, bound of a joint's step [rad or m]")),
        reference="Buss and Kim 2005",
        choose_it="targets at the edge of reach: damps only the directions that would throw the tip",
        budget=_STEADY,
    ),
    Method(
        name="tsvd",
        code=rules.TRUNCATED,
        targets=_ALL,
        parameters=(_GAIN, Parameter("threshold", 1e-4, "", "σ below this part of the largest one are left out")),
        reference="Maciejewski and Klein 1989, truncated singular value decomposition",
        choose_it="to give up lost directions instead of damping them",
        budget=_STEADY,
    ),
    Method(
        name="ccd",
        code=CCD,
        targets=_ALL,
        parameters=(),
        reference="Wang and Chen 1991, cyclic coordinate descent",
        choose_it="long chains and any joint, without a Jacobian; the error never grows",
        several_tips=False,
        weighs=0,
        budget=_STEADY,
    ),
    Method(
        name="ftl",
        code=FOLLOW_THE_LEADER,
        targets=("position",),
        parameters=(),
        reference="Brown, Latombe and Montgomery 2004, follow the leader",
        choose_it="to see the chain dragged by its tip like a rope",
        several_tips=False,
        weighs=0,
        hinges=True,
        budget=_STEADY,
    ),
    Method(
        name="fabrik",
        code=FABRIK,
        targets=("position",),
        parameters=(),
        reference="Bischoff 2016, Algorithm 1; Aristidou and Lasenby 2011",
        choose_it="positions on chains of hinges, without a Jacobian",
        weighs=0,
        hinges=True,
        budget=_STEADY,
    ),
    Method(
        name="closed",
        code=-1,
        targets=_ALL,
        parameters=(),
        reference="the forms of nao_kin.analytic.forms, each with its source",
        choose_it="chains with a closed form: of all branches within limits the nearest to q0, or a proof of none",
        kind="closed form",
        several_tips=False,
        weighs=0,
    ),
)

METHODS: Final[dict[str, Method]] = {method.name: method for method in _ROWS}
"""The methods by name."""


def method_named(name: str) -> Method:
    """The method of that name.

    Raises:
        UnknownNameError: There is none; carries near matches.
    """
    try:
        return METHODS[name]
    except (KeyError, TypeError):
        raise UnknownNameError("method", name, METHODS) from None
