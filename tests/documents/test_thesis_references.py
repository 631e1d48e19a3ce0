"""What thesis and hexapod article are held against is itself held against products of transforms written here."""

from __future__ import annotations

import math

import numpy as np
import pytest

from nao_kin.documents.claim import Claim, Verdict, judged
from nao_kin.documents.hexapod import hexapod_article as article
from nao_kin.documents.hexapod.hexapod_article import foot_of, stances, walker
from nao_kin.documents.judging import claims
from nao_kin.documents.thesis import closed_form as inverse
from nao_kin.documents.thesis.closed_form import table_counts
from nao_kin.documents.thesis.thesis_arms import Side, arm_configurations, described_arm, left_arm, right_arm, robot_arm
from nao_kin.se3 import rotation_x, rotation_y, rotation_z, translation

SIDES: tuple[Side, Side] = ("left", "right")


@pytest.mark.parametrize("side", SIDES)
def test_the_described_arm_is_the_product_of_its_joints(side: Side) -> None:
    arm, s = described_arm(side), 1.0 if side == "left" else -1.0
    for q in arm_configurations(side, 50, 1):
        upper = translation(0.0, s * 0.113, 0.100) * rotation_y(q[0]) * rotation_z(q[1]) * translation(0.105, 0.0, 0.0)
        hand = upper * rotation_x(q[2]) * rotation_z(q[3]) * translation(0.05595 + 0.05775, 0.0, 0.0)
        assert np.abs(arm.pose(q) - hand.homogeneous).max() < 1e-12
        assert np.abs(arm.elbow(q) - upper.translation).max() < 1e-12


@pytest.mark.parametrize("side", SIDES)
def test_it_is_the_thesis_table_in_the_modified_convention_but_for_its_forearm(side: Side) -> None:
    table = (left_arm() if side == "left" else right_arm()).read_as("modified")
    arm = described_arm(side)
    for q in arm_configurations(side, 50, 2):
        # thesis.left_arm has the minus of θ_3 in its table, and Table 4 has none
        theta = table_counts(q)
        found, wanted = table.pose(theta), arm.pose(q)
        assert np.linalg.norm(found.translation - wanted[:3, 3]) == pytest.approx(0.00003, abs=1e-9)  # 55.98 for 55.95
        turned = found.rotation if side == "left" else found.rotation @ rotation_z(math.pi).rotation
        assert np.abs(turned - wanted[:3, :3]).max() < 1e-12


@pytest.mark.parametrize("side", SIDES)
def test_describing_the_arm_leaves_the_robot_as_it_is(side: Side) -> None:
    described_arm(side)
    hand = robot_arm(side).pose(np.zeros(4)).translation
    assert hand == pytest.approx([0.2187, 0.113 if side == "left" else -0.113, 0.08769], abs=1e-12)


@pytest.mark.parametrize("bend", [math.radians(2.0), 0.3, math.pi / 2 - 1e-3, math.radians(88.5)])
@pytest.mark.parametrize("yaw", [0.0, 1.0, math.pi / 2, 2.0])
def test_the_corrected_equations_find_the_arm_at_its_limits_and_special_cases(bend: float, yaw: float) -> None:
    rng = np.random.default_rng(3)
    for side, pipeline in zip(SIDES, (inverse.left_pipeline_corrected, inverse.right_pipeline_corrected), strict=True):
        arm, s = described_arm(side), 1.0 if side == "left" else -1.0
        for roll in (0.0, float(rng.uniform(0.1, 1.2))):
            q = np.array([rng.uniform(0.3, 1.5), s * roll, yaw, -s * bend])
            with np.errstate(invalid="ignore"):
                candidates = pipeline(arm.pose(q), arm.shoulder, arm.l1, arm.l3, arm.l4)
            finite = candidates[np.isfinite(candidates).all(axis=1)]
            if not len(finite):  # rounding puts the sine of a quarter turn above 1
                assert yaw == math.pi / 2
                continue
            assert min(np.abs(np.sin(0.5 * (table_counts(c) - q))).max() for c in finite) < 1e-6


def test_feet_are_where_the_angles_of_the_legs_say() -> None:
    hips, hip, thigh, shin = walker()
    for stance in stances(5, 4):
        angles = np.array([leg.angles for leg in stance.legs])
        assert np.abs(foot_of(angles) - np.array([leg.foot for leg in stance.legs])).max() < 1e-9
        for leg, servo, (psi, rise, knee) in zip(stance.legs, hips, angles, strict=True):
            fall = rise - (math.pi - knee)  # the shin's direction, of a knee that is up
            out = hip + thigh * math.cos(rise) + shin * math.cos(fall)
            up = thigh * math.sin(rise) + shin * math.sin(fall)
            foot = servo + np.array([out * math.cos(psi), out * math.sin(psi), up])
            assert np.abs(foot - leg.foot).max() < 1e-8


def test_the_corrected_procedure_keeps_the_feet_where_the_printed_one_does_not() -> None:
    hips, *lengths = walker()
    for stance in stances(10, 5):
        arguments = (hips, tuple(lengths), stance.turn, stance.moved, stance.feet)
        wanted = np.array([leg.angles for leg in stance.legs])
        assert np.abs(article.whole_procedure_corrected(*arguments) - wanted).max() < 1e-9
        assert np.abs(article.whole_procedure(*arguments) - wanted).max() > 1e-3


def test_the_directed_a4_needs_no_foot_below_the_body() -> None:
    for h, g, below in ([(1, 0, 0), (1, 0, -1), 0.25], [(2, 0, 0), (1, 0, 1), -0.25], [(1, 0, 0), (-1, 0, -1), 0.75]):
        up = np.array([0.0, 0.0, 3.0])
        assert article.a4_corrected(np.array(h), np.array(g), up) == pytest.approx(below * math.pi)


@pytest.mark.parametrize(
    "claim", [c for c in claims() if c.correction and c.id[:3] in ("000", "002")], ids=lambda c: c.id
)
def test_corrections_hold_where_the_printed_form_holds_by_a_convention_only(claim: Claim) -> None:
    judgement = judged(claim)
    if judgement.verdict is not Verdict.holds_under_convention:
        return
    assert claim.correction is not None
    check = claim.correction.check or claim.check
    assert check(claim.correction.form).residual <= 1e-9
