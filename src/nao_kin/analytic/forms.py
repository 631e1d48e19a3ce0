"""The closed forms, one row each."""

from __future__ import annotations

from functools import partial
from typing import Final

from nao_kin.analytic.form import ClosedForm, Request
from nao_kin.analytic.hexapod import hexapod_leg
from nao_kin.analytic.nao import nao_arm, nao_arm_kernel, nao_head, nao_leg
from nao_kin.analytic.six_r import elbow, five_r, general, recognising, six_r_bent_wrist

__all__ = ["FORMS"]

_ARMS: Final = "Kofinas, Orfanoudakis and Lagoudakis 2013; Bischoff 2016, (3.3.0.2) ff."
_ELBOW_YAW, _WRIST_YAW = 2, 4  # columns of an arm's q

FORMS: Final = (
    ClosedForm(
        name="nao_head",
        title="NAO head: yaw and pitch",
        source="MATLAB example, eq1 to eq3",
        joints=2,
        requests={"pose": Request(1), "orientation": Request(1), "position": Request(2), "direction": Request(2)},
        labels=nao_head.LABELS,
        singularities=nao_head.SINGULARITIES,
        recognise=nao_head.recognise,
        solve=nao_head.solve,
        solve_many=nao_head.solve_many,
    ),
    ClosedForm(
        name="nao_arm_h21",
        title="NAO arm of four joints, wrist fixed",
        source=_ARMS,
        joints=4,
        requests={"pose": Request(4), "position": Request(4, (_ELBOW_YAW,)), "pointing": Request(24)},
        labels=nao_arm.LABELS,
        singularities=nao_arm.SINGULARITIES,
        recognise=partial(nao_arm.recognise, joints=4),
        solve=nao_arm_kernel.solve,
        solve_many=nao_arm_kernel.solve_many,
    ),
    ClosedForm(
        name="nao_arm_h25",
        title="NAO arm of five joints",
        source=_ARMS,
        joints=5,
        requests={"pose": Request(4), "position": Request(4, (_ELBOW_YAW, _WRIST_YAW)), "pointing": Request(8)},
        labels=nao_arm.LABELS,
        singularities=nao_arm.SINGULARITIES,
        recognise=partial(nao_arm.recognise, joints=5),
        solve=nao_arm_kernel.solve,
        solve_many=nao_arm_kernel.solve_many,
    ),
    ClosedForm(
        name="nao_leg",
        title="NAO leg of six joints, from torso to foot or from foot to torso",
        source="Kofinas, Orfanoudakis and Lagoudakis 2013, the leg; derived in nao_kin.analytic.nao.nao_leg",
        joints=6,
        requests={"pose": Request(nao_leg.BRANCHES)},
        labels=nao_leg.LABELS,
        singularities=nao_leg.SINGULARITIES,
        recognise=nao_leg.recognise,
        solve=nao_leg.solve,
        solve_many=nao_leg.solve_many,
    ),
    ClosedForm(
        name="six_r_spherical",
        title="arm with axes 2 and 3 parallel and a spherical wrist, or its mirror",
        source="Pieper 1968; as subproblems, Elias and Wen 2022",
        joints=6,
        requests={"pose": Request(elbow.BRANCHES)},
        labels=recognising.LABELS,
        singularities=recognising.SINGULARITIES,
        recognise=partial(recognising.recognise, kind=recognising.SPHERICAL),
        solve=elbow.solve_spherical,
        solve_many=elbow.solve_spherical_many,
    ),
    ClosedForm(
        name="six_r_parallel",
        title="arm with axes 2, 3 and 4 parallel and 5 and 6 meeting, as Universal Robots', or its mirror",
        source="Hawkins 2013; as subproblems, Elias and Wen 2022",
        joints=6,
        requests={"pose": Request(elbow.BRANCHES)},
        labels=recognising.LABELS,
        singularities=recognising.SINGULARITIES,
        recognise=partial(recognising.recognise, kind=recognising.THREE_PARALLEL),
        solve=elbow.solve_parallel,
        solve_many=elbow.solve_parallel_many,
    ),
    ClosedForm(
        name="six_r_bent_wrist",
        title="arm with axes 2 and 3 parallel, 4 and 5 meeting, 5 and 6 meeting, as JACO2, or its mirror",
        source="derived in nao_kin.analytic.six_r.six_r_bent_wrist",
        joints=6,
        requests={"pose": Request(six_r_bent_wrist.BRANCHES)},
        labels=recognising.LABELS,
        singularities=recognising.SINGULARITIES,
        recognise=partial(recognising.recognise, kind=recognising.BENT_WRIST),
        solve=six_r_bent_wrist.solve,
        solve_many=six_r_bent_wrist.solve_many,
    ),
    ClosedForm(
        name="hexapod_leg",
        title="hexapod leg: coxa, femur and tibia",
        source="hexapod article, steps 3 to 5",
        joints=3,
        requests={"position": Request(hexapod_leg.BRANCHES)},
        labels=hexapod_leg.LABELS,
        singularities=hexapod_leg.SINGULARITIES,
        recognise=hexapod_leg.recognise,
        solve=hexapod_leg.solve,
        solve_many=hexapod_leg.solve_many,
    ),
    ClosedForm(
        name="six_r",
        title="any arm of six turning joints, by elimination and by search; slow",
        source="Raghavan and Roth 1990; Manocha and Canny 1994",
        joints=6,
        requests={"pose": Request(general.BRANCHES)},
        labels=general.LABELS,
        singularities=general.SINGULARITIES,
        recognise=general.recognise,
        solve=general.solve,
        solve_many=general.solve_many,
    ),
    ClosedForm(
        name="five_r",
        title="any arm of five turning joints, as six with an imagined one; slow",
        source="Raghavan and Roth 1990; the imagined joint in nao_kin.analytic.six_r.five_r",
        joints=5,
        requests={"pose": Request(five_r.BRANCHES)},
        labels=general.LABELS,
        singularities=general.SINGULARITIES,
        recognise=five_r.recognise,
        solve=five_r.solve,
        solve_many=five_r.solve_many,
    ),
)
"""In the order in which they are tried."""
