"""Which names are twins, and what of twins is held against one another."""

from __future__ import annotations

import pytest
from tests.conftest import robot

from nao_kin.checks.rules.twin_rules import Symmetry, twins


@pytest.mark.parametrize(
    ("left", "right"),
    [
        ("LHipPitch", "RHipPitch"),
        ("LLEG_HIP_R", "RLEG_HIP_R"),
        ("l_wrist", "r_wrist"),
        ("left_arm_1_joint", "right_arm_1_joint"),
        ("arm_left_1_joint", "arm_right_1_joint"),
        ("armLeft", "armRight"),
        ("leftArm", "rightArm"),
        ("LEFT_ARM", "RIGHT_ARM"),
        ("j_thigh_lf", "j_thigh_rf"),
        ("FL_hip_joint", "FR_hip_joint"),
        ("RL_hip_joint", "RR_hip_joint"),
        ("LF_HAA", "RF_HAA"),
        ("leg_lr", "leg_rr"),
        ("LFsrFL_frame", "RFsrFR_frame"),
    ],
)
def test_names_for_left_and_right_are_twins(left: str, right: str) -> None:
    assert twins([right, left]) == {left: right}


@pytest.mark.parametrize(
    "names",
    [
        ("lift", "rift"),
        ("link_1", "rink_1"),
        ("wheel", "wheer"),
        ("LArm", "RLeg"),
        ("left", "left_right"),
        ("Lower", "Rower"),
    ],
)
def test_other_names_are_not(names: tuple[str, str]) -> None:
    assert twins(names) == {}


def test_a_name_with_several_sides_changes_them_all_if_it_can() -> None:
    names = [f"{foot}Fsr{place}" for foot in "LR" for place in ("FL", "FR", "RL", "RR")]
    assert twins(names) == {"LFsrFL": "RFsrFR", "LFsrFR": "RFsrFL", "LFsrRL": "RFsrRR", "LFsrRR": "RFsrRL"}


@pytest.mark.parametrize(("name", "axis"), [("nao_v50_h25", 1), ("phantomx", 1), ("jaco2", None)])
def test_the_plane_of_symmetry(name: str, axis: int | None) -> None:
    assert Symmetry.of(robot(name)).plane == axis
