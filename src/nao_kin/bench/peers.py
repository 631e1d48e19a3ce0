"""Other packages that solve inverse kinematics, each called the way that suits it best.

None of them is needed. One that is not installed, or does not do a chain, is left out with a line that says why.
"""

from __future__ import annotations

import importlib
import importlib.util
import math
import warnings
from collections.abc import Callable, Container, Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from nao_kin.bench.contest import Contender
from nao_kin.bench.referee import Referee

if TYPE_CHECKING:
    from nao_kin.arrays import Floats
    from nao_kin.bench.contest import SolverTask
    from nao_kin.robot.urdf_chain import UrdfChain

__all__ = ["PEERS", "Peer", "Unsuited", "installed_peers", "product_of_exponentials"]


class Unsuited(Exception):  # noqa: N818 - a refusal, not an error
    """A peer does not do this chain or this kind of target; the message says why."""


@dataclass(frozen=True)
class Peer:
    """A package to be measured beside ours.

    Attributes:
        name: What to call it.
        package: What to install.
        module: What to import.
        make: Sets it up for a task, or raises `Unsuited`.
    """

    name: str
    package: str
    module: str
    make: Callable[[SolverTask], Contender]


def installed_peers(task: SolverTask, only: Container[str] | None = None) -> tuple[list[Contender], list[str]]:
    """The peers that are installed and do this task, and lines about those that are left out."""
    found, left_out = [], dict[str, list[str]]()
    for peer in (peer for peer in PEERS.values() if only is None or peer.name in only):
        try:
            found.append(_set_up(peer, task))
        except Unsuited as reason:
            left_out.setdefault(str(reason), []).append(peer.name)
    return found, [f"Without {', '.join(names)}: {reason}." for reason, names in left_out.items()]


def _set_up(peer: Peer, task: SolverTask) -> Contender:
    if importlib.util.find_spec(peer.module) is None:
        raise Unsuited(f"to have it beside, pip install {peer.package}")
    try:
        with warnings.catch_warnings():  # others' warnings at import are not what this is about
            warnings.simplefilter("ignore")
            return peer.make(task)
    except ImportError as error:
        raise Unsuited(f"its import fails ({error})") from error


def _roboticstoolbox(task: SolverTask) -> Contender:
    """`ik_LM` on the chain's own geometry; at its default tolerance it stops a millimetre short.

    The tolerance is one on half the squared error, so at 1e-12 a few answers stop between 1 and 1.4 µm or µrad.
    """
    rtb = importlib.import_module("roboticstoolbox")
    path = task.chain.joint_path
    if len(path.columns) != len(path.lower):
        raise Unsuited("no coupled joints in ik_LM")
    sequence = None
    for k, column in enumerate(path.columns):
        placement = rtb.ET.SE3(_matrix(path.rotations[k], path.translations[k]))
        ends = np.clip([path.lower[column], path.upper[column]], -2 * math.pi, 2 * math.pi)
        joint = rtb.ET.tz(qlim=ends) if path.prismatic[k] else rtb.ET.Rz(qlim=ends)
        sequence = placement * joint if sequence is None else sequence * placement * joint
    sequence = sequence * rtb.ET.SE3(_matrix(path.tool_rotation, path.tool_translation))
    solve, start = sequence.ik_LM, task.start
    mask = None if task.kind == "pose" else np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
    return Contender(
        name="roboticstoolbox",
        call=lambda T: solve(T, q0=start, tol=1e-12, mask=mask),
        joints=lambda solution: np.asarray(solution.q) if solution.success else None,
    )


def _ssik(task: SolverTask) -> Contender:
    """Its ready-made arm of the same name, if that is the same arm; deriving another one takes it a minute."""
    _only_poses(task)
    chain = task.chain
    try:
        arm = importlib.import_module("ssik.prebuilt")
        arm = getattr(arm, f"{chain.robot.name}_ik")
    except AttributeError:
        raise Unsuited(f"no ready-made {chain.robot.name}") from None
    q = np.linspace(0.1, 0.9, len(chain.joints))
    if len(q) != arm.DOF or np.abs(np.asarray(arm.fk(q)) - Referee(chain).pose(q)).max() > 1e-9:
        raise Unsuited(f"its ready-made {chain.robot.name} has other lengths or frames")
    solve = arm.solve
    return Contender(
        name="ssik",
        call=lambda T: solve(T, max_solutions=1, enumerate_windings=False),
        joints=lambda solutions: np.asarray(solutions[0].q) if solutions else None,
    )


def _eaik(task: SolverTask) -> Contender:
    """All closed-form branches, the first one inside the limits; it takes axes H and points P and no tool rotation."""
    _only_poses(task)
    H, P, R_last_tip = product_of_exponentials(task.chain)
    robot = importlib.import_module("eaik.IK_HP").HPRobot(H, P)
    if not robot.hasKnownDecomposition():
        raise Unsuited("no known decomposition of this arm")
    inside, undo = _first_inside(task.chain), R_last_tip.T

    def call(T: Floats) -> Floats | None:
        wanted = T.copy()
        wanted[:3, :3] = T[:3, :3] @ undo
        found = robot.IK(wanted)
        return inside(q for q, nearest_only in zip(found.Q, found.is_LS, strict=True) if not nearest_only)

    return Contender("eaik", call, lambda q: q)


def _ik_geo(task: SolverTask) -> Contender:
    """All closed-form branches, the first one inside the limits; it takes rotations column by column."""
    _only_poses(task)
    if task.chain.robot.name not in ("ur3", "ur5", "ur10"):
        raise Unsuited("it must be told the class of an arm, known here for the UR arms only")
    H, P, R_last_tip = product_of_exponentials(task.chain)
    robot = importlib.import_module("ik_geo").Robot.three_parallel_two_intersecting(H.tolist(), P.tolist())
    inside = _first_inside(task.chain)

    def call(T: Floats) -> Floats | None:
        found = robot.get_ik((R_last_tip @ T[:3, :3].T).tolist(), T[:3, 3].tolist())
        return inside(np.array(q) for q, nearest_only in found if not nearest_only)

    return Contender("ik-geo", call, lambda q: q)


def _pink(task: SolverTask) -> Contender:
    """A frame task with full Gauss-Newton steps, at most 100; it has no restarts."""
    import pinocchio as pin

    _only_poses(task)
    chain = task.chain
    model: Any = chain.robot.model
    if chain.joint_names != tuple(model.names)[1:] or model.nq != model.nv:
        raise Unsuited("it moves all joints of a robot, not those of one chain")
    pink = importlib.import_module("pink")
    frame_task = importlib.import_module("pink.tasks").FrameTask(chain.tip, 1.0, 1.0, lm_damping=1e-6)
    solvers = importlib.import_module("qpsolvers").available_solvers
    if not solvers:
        raise Unsuited("it needs a QP solver, for example pip install quadprog")
    solver, start = ("quadprog" if "quadprog" in solvers else solvers[0]), task.start
    data = model.createData()
    pin.framesForwardKinematics(model, data, pin.neutral(model))
    T_root_base = pin.SE3(data.oMf[model.getFrameId(chain.base)])

    def call(T: Floats) -> Any:
        configuration = pink.Configuration(model, data, start.copy())
        frame_task.set_target(T_root_base * pin.SE3(T))
        for _ in range(100):
            if np.linalg.norm(frame_task.compute_error(configuration)) < 1e-7:
                return configuration.q
            step = pink.solve_ik(configuration, [frame_task], 1.0, solver=solver, safety_break=False)
            configuration.integrate_inplace(step, 1.0)
        return None

    return Contender("pink", call, lambda q: q)


def _pytracik(task: SolverTask) -> Contender:
    """TRAC-IK with time for restarts; its tolerance holds for each component, and its default is too coarse here."""
    _only_poses(task)
    chain = task.chain
    file = chain.robot.document.path
    solver = importlib.import_module("trac_ik").TracIK(chain.base, chain.tip, file, timeout=0.05, epsilon=1e-7)
    solve, start = solver.ik, task.start
    return Contender(
        name="pytracik",
        call=lambda T: solve(T[:3, 3], T[:3, :3], seed_jnt_values=start),
        joints=lambda q: None if q is None else np.asarray(q),
    )


def _only_poses(task: SolverTask) -> None:
    if task.kind != "pose":
        raise Unsuited("full poses only")


def _matrix(R: Floats, p: Floats) -> Floats:
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R, p
    return T


def product_of_exponentials(chain: UrdfChain) -> tuple[Floats, Floats, Floats]:
    """Joint axes (6, 3) and steps between points on them, the tip last (7, 3), in base axes, and the tip's rotation."""
    path = chain.joint_path
    if len(path.columns) != 6 or path.prismatic.any() or len(path.lower) != 6:
        raise Unsuited("arms with six turning joints only")
    axes, steps, R = [], [], np.eye(3)
    for placement, offset in zip(path.rotations, path.translations, strict=True):
        steps.append(R @ offset)
        R = R @ placement
        axes.append(R[:, 2])
    steps.append(R @ path.tool_translation)
    return np.array(axes), np.array(steps), R @ path.tool_rotation


def _first_inside(chain: UrdfChain) -> Callable[[Iterable[Floats]], Floats | None]:
    lower, upper = chain.lower, chain.upper
    return lambda candidates: next((q for q in candidates if (q >= lower).all() and (q <= upper).all()), None)


PEERS: dict[str, Peer] = {
    peer.name: peer
    for peer in (
        Peer("roboticstoolbox", "roboticstoolbox-python", "roboticstoolbox", _roboticstoolbox),
        Peer("ssik", "ssik", "ssik", _ssik),
        Peer("eaik", "eaik", "eaik", _eaik),
        Peer("ik-geo", "ik-geo", "ik_geo", _ik_geo),
        Peer("pink", "'pin-pink' quadprog", "pink", _pink),
        Peer("pytracik", "pytracik", "trac_ik", _pytracik),
    )
}
"""By name; a further one needs only another row."""
