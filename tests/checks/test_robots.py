"""Real robots: ours are without warnings, and others have no error that is not a defect."""

from __future__ import annotations

from collections import Counter

import pytest
from tests.conftest import BUNDLED, needs_examples

import nao_kin as nk
from nao_kin.checks.finding import Severity
from nao_kin.robot.known import example_robot_data_share

# Each looked at by hand; docs/check.md says why it is a defect.
KNOWN_ERRORS = {
    "alex_description/urdf/alex_psyonic_hands.urdf": {"unknown-leader": 8},
    "romeo_description/urdf/romeo_laas_small.urdf": {"inertia-not-positive": 3},
    "tiago_description/robots/tiago.urdf": {"inertia-not-positive": 2},
    "tiago_description/robots/tiago_dual.urdf": {"inertia-not-positive": 2},
    "tiago_description/robots/tiago_no_hand.urdf": {"inertia-not-positive": 2},
    "ur_description/urdf/ur3.urdf": {"no-name": 1},
}
"""Errors by file of example-robot-data 6."""

# The heads of our files are English sentences; small parts inside others collide with nothing of their own.
OUR_NOTES = {"colon-in-comment", "no-collision"}

# Asymmetries that the NAO's own documentation prints; docs/check.md lists them.
NAO_NOTES = {"mirror-limit", "mirror-effort", "mirror-inertia", "mirror-frame", "shared-name", *OUR_NOTES}


@pytest.mark.parametrize("name", BUNDLED)
def test_our_robots_have_neither_errors_nor_warnings(name: str) -> None:
    report = nk.check(name, thorough=True)
    assert report.at_or_above(Severity.warning) == ()
    assert set(report.codes) <= (NAO_NOTES if name.startswith("nao") else {"often-in-collision", *OUR_NOTES})


def test_every_error_of_the_example_robots_is_a_known_defect() -> None:
    needs_examples()
    share = example_robot_data_share()
    assert share is not None
    folder = share / "example-robot-data" / "robots"
    files = sorted(folder.rglob("*.urdf"))
    assert len(files) >= 60
    found = {}
    for path in files:
        errors = nk.check(path).errors
        if errors:
            found[str(path.relative_to(folder))] = dict(Counter(finding.code for finding in errors))
    assert found == KNOWN_ERRORS
