"""Coupled limits for compiled loops, against the rules they are packed from."""

from __future__ import annotations

import numpy as np

from nao_kin.kernels.joint_limits import column_range, decides, packed_rules
from tests.conftest import robot


def test_the_range_of_a_column_is_its_own_cut_down_by_its_rule(rng: np.random.Generator) -> None:
    for part in ("head", "left_leg", "right_leg"):
        chain = robot("nao_v50_h25").chain(part)
        (rule,) = chain.limit_rules
        limits, coupled = np.array([chain.lower, chain.upper]), packed_rules(chain.limit_rules, chain.joint_names)
        limited, deciding = (chain.joint_names.index(joint) for joint in (rule.joint, rule.by))
        for q in rng.uniform(-3.0, 3.0, size=(200, len(chain.joints))):
            for i in range(len(q)):
                lower, upper = chain.lower[i], chain.upper[i]
                if i == limited:
                    least, greatest = rule.range(q[deciding])
                    lower, upper = max(lower, least), min(upper, greatest)
                np.testing.assert_allclose(column_range(limits, coupled, q, i), (lower, upper), atol=1e-15)
                assert decides(coupled, i) == (i == deciding)
