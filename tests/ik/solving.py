"""Chains, targets and calls that the tests of the compiled loop share."""

from __future__ import annotations

import numpy as np

from nao_kin.chain import Chain, random_configurations
from nao_kin.ik.compiled import run_of, settings_of, solve_goal, tables_of, trace_rows
from nao_kin.ik.methods import METHODS
from nao_kin.ik.problem import Problem, Run
from nao_kin.ik.reference_loop import Budget, Update, run_reference
from nao_kin.ik.target import KINDS, Target
from nao_kin.se3 import rotation_angle
from nao_kin.tolerances import TOLERANCES
from tests.conftest import needs_examples, robot

CHAINS = [
    ("jaco2", "arm", "pose"),
    ("nao_v50_h25", "left_leg", "pose"),
    ("nao_v50_h25", "right_leg", "pose"),
    ("nao_v33_h21", "left_arm", "position"),
    ("phantomx", "leg_rm", "position"),
]
OPTIONAL = [
    ("ur5", "arm", "pose"),
    ("panda", "arm", "pose"),
    ("xarm7", "arm", "pose"),
    ("talos", "left_arm", "pose"),
    ("talos", "right_arm", "pose"),
]
ONE_STEP = Budget(iterations=1, restarts=0)


def chain_of(name: str, chain: str) -> Chain:
    if any(name == optional for optional, *_ in OPTIONAL):
        needs_examples()
    return robot(name).chain(chain)


def goals_of(chain: Chain, count: int, rng: np.random.Generator) -> np.ndarray:
    return np.ascontiguousarray([chain.pose(q).homogeneous for q in random_configurations(chain, count, rng)])


def settings(chain: Chain, kind: str = "pose", budget: Budget | None = None, **options: object) -> np.ndarray:
    code, tolerances = KINDS[kind], options.pop("tolerances", TOLERANCES)
    options.setdefault("parameters", METHODS["lm"].tuned({}, None))
    return settings_of(tables_of(chain), code, METHODS["lm"].code, budget or Budget(), tolerances, **options)


def compiled(
    chain: Chain, goal: np.ndarray, q0: np.ndarray, kind: str = "pose", budget: Budget | None = None, **options: object
) -> Run:
    tables, chosen = tables_of(chain), settings(chain, kind, budget or Budget(), **options)
    trace = trace_rows(solve_goal(tables, chosen, goal, q0), len(chain.joints))
    return run_of(solve_goal(tables, chosen, goal, q0, trace), KINDS[kind], trace)


def reference(chain: Chain, goal: np.ndarray, q0: np.ndarray, kind: str, budget: Budget) -> Run:
    problem = Problem(chain, Target(kind, goal.copy()))
    method = Update(METHODS["lm"].code, METHODS["lm"].tuned({}, None))
    return run_reference(problem, method, q0, budget, np.random.default_rng(0), keep_trace=True)


def errors(chain: Chain, q: np.ndarray, goal: np.ndarray) -> tuple[float, float]:
    T = chain.pose(q)
    return float(np.linalg.norm(T.translation - goal[:3, 3])), rotation_angle(T.rotation.T @ goal[:3, :3])


def smallest_singular_value(chain: Chain, q: np.ndarray, rows: slice) -> float:
    return float(np.linalg.svd(chain.jacobian(q)[rows], compute_uv=False)[-1])
