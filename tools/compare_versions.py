"""Generated URDF files of the versions 1.0, 1.1 and 1.2, read by us and by Pinocchio's own reader.

python tools/compare_versions.py                      2000 files; exit status 1 if one differs
python tools/compare_versions.py --files 200 --seed 1

Compared: whether the file is taken at all, forward kinematics, inertias, limits, capsules and cylinders.
"""

from __future__ import annotations

import argparse
import os
import sys
from collections import Counter

import numpy as np

from check_trials.against_pinocchio import departure
from check_trials.versions import versioned_robot
from nao_kin.errors import UrdfError
from nao_kin.urdf import parse_urdf


def main() -> int:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--files", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stderr.fileno())  # urdfdom writes to the C stream
    taken, different = Counter[str](), []
    for number in range(arguments.files):
        data = versioned_robot(np.random.default_rng([arguments.seed, number]))
        taken[_outcome(data)] += 1
        if found := departure(data, number):
            different.append(f"file {number}: {found}")
    for outcome, count in sorted(taken.items()):
        print(f"{outcome:30}{count}")
    print(f"{'different from Pinocchio':30}{len(different)}")
    for line in different[:50]:
        print(f"  {line}")
    return 1 if different else 0


def _outcome(data: bytes) -> str:
    try:
        parse_urdf(data)
    except UrdfError as refusal:
        return f"refused: {refusal.code}"
    return "loaded"


if __name__ == "__main__":
    sys.exit(main())
