"""Configurations by number: inside the limits, the same however they are asked for, and as random as they say."""

from __future__ import annotations

import numpy as np
import pytest

import nao_kin as nk
from nao_kin.chain import outside_limits, sampling_range
from nao_kin.kernels.reaching import Samples, configurations
from nao_kin.workspace.sampling import samples_of
from tests.conftest import robot
from tests.kernels.paths import odd_robot

CHAINS = (("nao", "left_arm"), ("nao", "head"), ("nao", "left_leg"), ("jaco2", "arm"))


@pytest.mark.parametrize(("name", "part"), CHAINS)
@pytest.mark.parametrize("sampling", ["random", "even"])
def test_they_are_within_all_limits_and_fill_them(name: str, part: str, sampling) -> None:
    chain = robot(name).chain(part)
    Q = configurations(samples_of(chain, sampling, 3), 0, 5000)
    assert not any(outside_limits(chain, q) for q in Q)
    lower, upper = sampling_range(chain)
    limited = {rule.joint for rule in chain.limit_rules}
    for i, joint in enumerate(chain.joint_names):
        u = (Q[:, i] - lower[i]) / (upper[i] - lower[i])
        if joint not in limited:  # uniform: the greatest gap to the distribution function is 1.95 / √N in 999 of 1000
            assert np.abs(np.sort(u) - np.linspace(0.0, 1.0, len(u))).max() < 1.95 / np.sqrt(len(u))


@pytest.mark.parametrize("part", ["head", "left_leg"])
def test_a_coupled_joint_is_uniform_in_what_the_other_one_leaves(part: str) -> None:
    chain = robot("nao").chain(part)
    (rule,) = chain.limit_rules
    Q = configurations(samples_of(chain), 0, 5000)
    limited, deciding = (chain.joint_names.index(joint) for joint in (rule.joint, rule.by))
    ranges = np.array([rule.range(by) for by in Q[:, deciding]])
    low = np.maximum(ranges[:, 0], chain.lower[limited])
    high = np.minimum(ranges[:, 1], chain.upper[limited])
    u = np.sort((Q[:, limited] - low) / (high - low))
    assert np.abs(u - np.linspace(0.0, 1.0, len(u))).max() < 1.95 / np.sqrt(len(u))


def test_number_i_is_the_same_whoever_asks(tmp_path) -> None:
    for chain in (robot("nao").chain("left_leg"), odd_robot(tmp_path).chain("base", "tip")):
        for sampling in ("random", "even"):
            samples = samples_of(chain, sampling, 9)
            whole = configurations(samples, 0, 1000)
            cuts = ((0, 1), (1, 63), (64, 500), (564, 436))
            pieces = [configurations(samples, first, count) for first, count in cuts]
            np.testing.assert_array_equal(np.concatenate(pieces), whole)
            assert len(np.unique(whole[:, 0])) == len(whole)


def unit_interval(start: int, step: int, mixed: int) -> Samples:
    limits = np.array([[0.0], [1.0]])
    words = np.array([start % 2**64], np.uint64), np.array([step % 2**64], np.uint64)
    return Samples(*words, mixed, limits, np.zeros((0, 7)), np.zeros(0, np.int64))


def test_random_numbers_are_those_of_splitmix64() -> None:
    # The published output of the reference implementation for the seed 1234567.
    reference = (6457827717110365317, 3203168211198807973, 9817491932198370423, 4593380528125082431)
    step = 0x9E3779B97F4A7C15
    found = configurations(unit_interval(1234567 + step, step, 1), 0, 4)[:, 0]
    assert found.tolist() == [float(word >> 11) / 2.0**53 for word in reference]


def test_numbers_beyond_32_bits_wrap_as_whole_numbers_do() -> None:
    start, step, first = 2**63 + 12345, 0x9E3779B97F4A7C15, 2**40 + 7
    found = configurations(unit_interval(start, step, 0), first, 5)[:, 0]
    assert found.tolist() == [float((start + i * step) % 2**64 >> 11) / 2.0**53 for i in range(first, first + 5)]


def test_even_samples_leave_smaller_gaps_than_chance() -> None:
    row = {"a": 1.0, "alpha": 0.0, "d": 0.0, "theta": 0.0, "lower": 0.0, "upper": 1.0}
    chain = nk.DHChain.from_table([row], "standard")
    gaps = {
        sampling: np.diff(np.sort(configurations(samples_of(chain, sampling), 0, 1000)[:, 0])).max()
        for sampling in ("random", "even")
    }
    assert gaps["even"] < 2.0 / 1000  # steps of the golden ratio leave gaps of at most (1 + 1 / √5) / N for large N
    assert gaps["random"] > 4.0 / 1000


def test_other_seeds_are_other_samples() -> None:
    chain = robot("nao").chain("left_arm")
    for sampling in ("random", "even"):
        a, b = (configurations(samples_of(chain, sampling, seed), 0, 100) for seed in (0, 1))
        assert np.abs(a - b).min() > 0.0


@pytest.mark.parametrize("seed", [-1, 0.5, True, "1"])
def test_a_bad_seed_is_refused(seed: object) -> None:
    with pytest.raises(nk.NaoKinError, match="seed: expected a whole number"):
        samples_of(robot("nao").chain("head"), seed=seed)  # type: ignore[arg-type]


def test_an_unknown_sampling_is_refused_with_what_there_is() -> None:
    with pytest.raises(nk.NaoKinError, match="Did you mean 'random'"):
        samples_of(robot("nao").chain("head"), "randon")  # type: ignore[arg-type]
