"""Errors keep their data on every way that errors travel."""

from __future__ import annotations

import copy
import pickle

import pytest

from nao_kin import errors

LEAVES = (
    errors.AuditError(3, "1 m", "2 m"),
    errors.FrameError("a length of 0 bytes", fatal=True),
    errors.UnknownNameError("frame", "larm", ["LArm", "RArm"], "nao"),
    errors.InvalidInputError("q", "5 numbers", "4 numbers"),
    errors.NoPathError("l_sole", "LLeg", "nao"),
    errors.MissingExtraError("Robot 'ur5'", "robots"),
    errors.UrdfError("a.urdf", 3, "Wrong.", "Right."),
    errors.TableFileError("a.toml", None, "Wrong."),
    errors.TrajectoryFileError("a.txt", 3, "Wrong.", column=2),
    errors.KeyframeFileError("a.toml", 3, "Wrong."),
)


@pytest.mark.parametrize("error", LEAVES, ids=lambda error: type(error).__name__)
def test_an_error_survives_pickling_and_copying(error: errors.NaoKinError) -> None:
    for again in (pickle.loads(pickle.dumps(error)), copy.copy(error), copy.deepcopy(error)):  # noqa: S301 - our own
        assert type(again) is type(error)
        assert str(again) == str(error)
        assert vars(again) == vars(error)


def test_every_leaf_is_tried() -> None:
    public = {getattr(errors, name) for name in errors.__all__}
    assert {type(error) for error in LEAVES} == public - {errors.NaoKinError}


def test_near_matches_do_not_mind_case_or_kind() -> None:
    assert errors.near_matches("LARM", ["RArm", "LArm"])[0] == "LArm"
    assert errors.UnknownNameError("frame", None, ["LArm"]).name == "None"  # type: ignore[arg-type]
    many = errors.UnknownNameError("frame", "zzz", [f"f{k}" for k in range(40)])
    assert many.near == ()
    assert "f11, …" in str(many)
