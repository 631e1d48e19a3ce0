"""nao_kin: the robot's model is the truth.

Load a robot from a URDF, hold hand-written DH tables against it, solve inverse kinematics on it, write pages.
Everything is imported on first use, so that `import nao_kin` costs next to nothing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from nao_kin.lazy import lazily
from nao_kin.moved import answer_for_old_places

if TYPE_CHECKING:
    from nao_kin.analytic.solution_batch import BatchSolutions as BatchSolutions
    from nao_kin.analytic.solution_batch import solve_all_batch as solve_all_batch
    from nao_kin.analytic.solutions import Solutions as Solutions
    from nao_kin.analytic.solutions import nearest as nearest
    from nao_kin.analytic.solutions import solve_all as solve_all
    from nao_kin.calibration.calibration import Calibration as Calibration
    from nao_kin.calibration.calibration import calibrate as calibrate
    from nao_kin.calibration.measurements import Measurements as Measurements
    from nao_kin.chain import Chain as Chain
    from nao_kin.chain import ChainJoint as ChainJoint
    from nao_kin.chain import LimitRule as LimitRule
    from nao_kin.checks.checker import check as check
    from nao_kin.checks.finding import Finding as Finding
    from nao_kin.checks.finding import Report as Report
    from nao_kin.collision.model import CollisionModel as CollisionModel
    from nao_kin.crosscheck import Comparison as Comparison
    from nao_kin.crosscheck import compare as compare
    from nao_kin.dh.dh_chain import DHChain as DHChain
    from nao_kin.dh.dh_row import DHRow as DHRow
    from nao_kin.dh.from_chain import to_dh as to_dh
    from nao_kin.documents.chains import document_chain as document_chain
    from nao_kin.documents.chains import document_chain_names as document_chain_names
    from nao_kin.documents.judging import Ledger as Ledger
    from nao_kin.documents.judging import ledger as ledger
    from nao_kin.errors import NaoKinError as NaoKinError
    from nao_kin.ik.batch import BatchResult as BatchResult
    from nao_kin.ik.border import project_to_reach as project_to_reach
    from nao_kin.ik.methods import METHODS as METHODS
    from nao_kin.ik.problem import IKResult as IKResult
    from nao_kin.ik.problem import Status as Status
    from nao_kin.ik.reference_loop import Budget as Budget
    from nao_kin.ik.target import Target as Target
    from nao_kin.ik.tips.tree_problem import TreeResult as TreeResult
    from nao_kin.ik.tips.tree_solver import solve_tree as solve_tree
    from nao_kin.robot.known import robot_names as robot_names
    from nao_kin.robot.robot import Robot as Robot
    from nao_kin.robot.robot import load as load
    from nao_kin.robot.tree import Tree as Tree
    from nao_kin.robot.urdf_chain import UrdfChain as UrdfChain
    from nao_kin.solving import solve as solve
    from nao_kin.solving import solve_batch as solve_batch
    from nao_kin.tolerances import Tolerances as Tolerances
    from nao_kin.trajectory.causes import Cause as Cause
    from nao_kin.trajectory.files.reading import read_trajectory as read_trajectory
    from nao_kin.trajectory.files.reading import write_trajectory as write_trajectory
    from nao_kin.trajectory.following import FollowResult as FollowResult
    from nao_kin.trajectory.following import follow as follow
    from nao_kin.trajectory.joint_space import joint_motion as joint_motion
    from nao_kin.trajectory.paths import PoseLine as PoseLine
    from nao_kin.trajectory.paths import PositionLine as PositionLine
    from nao_kin.trajectory.paths import Screw as Screw
    from nao_kin.trajectory.replaying import Replay as Replay
    from nao_kin.trajectory.replaying import replay as replay
    from nao_kin.trajectory.timing import timed as timed
    from nao_kin.trajectory.trajectory import Trajectory as Trajectory
    from nao_kin.trajectory.trapezoid import Trapezoid as Trapezoid
    from nao_kin.view.export import export_html as export_html
    from nao_kin.view.export import show as show
    from nao_kin.workspace.mapping import reachability as reachability
    from nao_kin.workspace.reach_map import ReachMap as ReachMap

__version__ = "0.1.0"

_HOME = {
    "BatchResult": "ik.batch",
    "BatchSolutions": "analytic.solution_batch",
    "Budget": "ik.reference_loop",
    "Calibration": "calibration.calibration",
    "Cause": "trajectory.causes",
    "Chain": "chain",
    "ChainJoint": "chain",
    "CollisionModel": "collision.model",
    "Comparison": "crosscheck",
    "DHChain": "dh.dh_chain",
    "DHRow": "dh.dh_row",
    "Finding": "checks.finding",
    "FollowResult": "trajectory.following",
    "IKResult": "ik.problem",
    "Ledger": "documents.judging",
    "LimitRule": "chain",
    "METHODS": "ik.methods",
    "Measurements": "calibration.measurements",
    "NaoKinError": "errors",
    "PoseLine": "trajectory.paths",
    "PositionLine": "trajectory.paths",
    "ReachMap": "workspace.reach_map",
    "Replay": "trajectory.replaying",
    "Report": "checks.finding",
    "Robot": "robot.robot",
    "Screw": "trajectory.paths",
    "Solutions": "analytic.solutions",
    "Status": "ik.problem",
    "Target": "ik.target",
    "Tolerances": "tolerances",
    "Trajectory": "trajectory.trajectory",
    "Trapezoid": "trajectory.trapezoid",
    "Tree": "robot.tree",
    "TreeResult": "ik.tips.tree_problem",
    "UrdfChain": "robot.urdf_chain",
    "calibrate": "calibration.calibration",
    "check": "checks.checker",
    "compare": "crosscheck",
    "document_chain": "documents.chains",
    "document_chain_names": "documents.chains",
    "export_html": "view.export",
    "follow": "trajectory.following",
    "joint_motion": "trajectory.joint_space",
    "ledger": "documents.judging",
    "load": "robot.robot",
    "nearest": "analytic.solutions",
    "project_to_reach": "ik.border",
    "reachability": "workspace.mapping",
    "read_trajectory": "trajectory.files.reading",
    "replay": "trajectory.replaying",
    "robot_names": "robot.known",
    "show": "view.export",
    "solve": "solving",
    "solve_all": "analytic.solutions",
    "solve_all_batch": "analytic.solution_batch",
    "solve_batch": "solving",
    "solve_tree": "ik.tips.tree_solver",
    "timed": "trajectory.timing",
    "to_dh": "dh.from_chain",
    "write_trajectory": "trajectory.files.reading",
}

__all__ = list(_HOME)


__getattr__ = lazily(__name__, _HOME)
answer_for_old_places()


def __dir__() -> list[str]:
    return sorted([*globals(), *_HOME])
