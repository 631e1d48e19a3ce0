"""Configurations inside the limits, by number: the same ones whoever computes them, in which order and how many."""

from __future__ import annotations

import graphlib
from typing import TYPE_CHECKING, Final, Literal, TypeAlias, get_args

import numpy as np

from nao_kin.chain import sampling_range
from nao_kin.errors import InvalidInputError, UnknownNameError
from nao_kin.kernels.joint_limits import packed_rules
from nao_kin.kernels.reaching import Samples

if TYPE_CHECKING:
    from collections.abc import Sequence

    from nao_kin.chain import Chain, LimitRule

__all__ = ["Sampling", "samples_of"]

Sampling: TypeAlias = Literal["random", "even"]

_GOLDEN: Final = 0x9E3779B97F4A7C15  # 2⁶⁴ / golden ratio, odd: the step of SplitMix64


def samples_of(chain: Chain, sampling: Sampling = "random", seed: int = 0) -> Samples:
    """A sequence of configurations of a chain, which `nao_kin.kernels.reaching.configurations` writes out.

    ``"random"``: every joint independent and uniform in its range, by SplitMix64 (Steele, Lea and Flood 2014), a
    generator that gives the number i by itself. ``"even"``: an additive recurrence, which fills the ranges with smaller
    gaps than chance does; its steps are the powers of the generalised golden ratio (M. Roberts, "The unreasonable
    effectiveness of quasirandom sequences", 2018), its start is random.

    A joint without limits turns through ±π. A coupled limit cuts a joint's range down to what the deciding joint
    leaves, and the joint is uniform in that.

    Raises:
        InvalidInputError: The seed is not a whole number ≥ 0.
        UnknownNameError: There is no such way of sampling.
    """
    if isinstance(seed, bool) or not isinstance(seed, int | np.integer) or seed < 0:
        raise InvalidInputError("seed", "a whole number ≥ 0", repr(seed))
    if sampling not in get_args(Sampling):
        raise UnknownNameError("sampling", sampling, get_args(Sampling))
    n = len(chain.joints)
    column = {name: i for i, name in enumerate(chain.joint_names)}
    steps = [_GOLDEN] * n if sampling == "random" else _even_steps(n)
    return Samples(
        starts=np.random.SeedSequence(int(seed)).generate_state(n, np.uint64).astype(np.uint64),
        steps=np.array(steps, dtype=np.uint64),
        mixed=int(sampling == "random"),
        limits=np.ascontiguousarray(sampling_range(chain)),
        coupled=packed_rules(chain.limit_rules, chain.joint_names),
        cut=np.array([column[name] for name in _limited(chain.limit_rules)], dtype=np.int64),
    )


def _even_steps(n: int) -> list[int]:
    """2⁶⁴ / φ, 2⁶⁴ / φ² … with φ > 1 the root of φⁿ⁺¹ = φ + 1, each made odd so that no period is short."""
    golden = 2.0
    for _ in range(200):  # a contraction; it has long stopped moving
        golden = (1.0 + golden) ** (1.0 / (n + 1))
    return [int(2.0**64 / golden ** (j + 1)) | 1 for j in range(n)]


def _limited(rules: Sequence[LimitRule]) -> list[str]:
    """The joints with coupled limits, each after the joints that decide its range."""
    deciding: dict[str, set[str]] = {}
    for rule in rules:
        deciding.setdefault(rule.joint, set()).add(rule.by)
    try:
        order = list(graphlib.TopologicalSorter(deciding).static_order())
    except graphlib.CycleError:  # then any order will do: the kernel moves what is left outside to its limits
        order = list(deciding)
    return [name for name in order if name in deciding]
