"""Everything that a page can show, in the browser: drawn, complete, silent, and what can be played plays."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

import nao_kin as nk
from nao_kin.analytic.hexapod.body import body_ik
from nao_kin.motion.hexapod.footfall import LEGS
from nao_kin.motion.hexapod.gait import walk
from nao_kin.motion.hexapod.walk_request import WalkCommand
from nao_kin.se3 import from_xyz_rpy
from tests.browser.seeing import drive, number, pixels, robot_mask, slide, slide_all, tip, tip_shown
from tests.conftest import robot

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from pathlib import Path

    from tests.browser.conftest import Visit

    Show = Callable[..., Visit]


@pytest.fixture
def shown(tmp_path: Path, visit: Callable[..., Any]) -> Iterator[Show]:
    """Opens the page of something; afterwards nothing was said on the console and nothing asked for but the file."""
    opened: list[tuple[Visit, str]] = []

    def start(*what: Any, size: tuple[int, int] = (960, 640), **options: Any) -> Visit:
        path = nk.export_html(tmp_path / "out.html", *what, **options)
        opened.append((visit(path, *size), path.as_uri()))
        return opened[-1][0]

    yield start
    for visited, address in opened:
        assert visited.requests == [address]
        assert (visited.console, visited.errors) == ([], [])


def drawn(page: Any) -> float:
    """Share of the picture that is neither background nor ground."""
    return float(robot_mask(page).mean())


def jaco2_target() -> Any:
    return robot("jaco2").chain("arm").pose(np.radians([180, 270, 90, 180, 180, 0]))


def test_named_postures_are_chosen_from_a_list_the_others_are_ghosts(shown: Show) -> None:
    nao = robot("nao")
    wave = {**nao.neutral, "LShoulderPitch": -1.2, "LShoulderRoll": 0.4}
    page = shown(nao, {"neutral": nao.neutral, "wave": wave}).page
    assert drawn(page) > 0.02
    assert page.evaluate("() => naoKin.viewer.scene.children.length") > 0
    with_ghost = pixels(page)
    page.locator("#ghosts").uncheck()
    assert (np.abs(with_ghost - pixels(page)).max(axis=2) > 12).sum() > 500
    page.locator("#p1").check()
    assert page.evaluate("() => naoKin.state.values") == list(wave.values())


def test_all_branches_of_a_target_with_their_errors_and_limits(shown: Show) -> None:
    arm = robot("jaco2").chain("arm")
    solutions = nk.solve_all(arm, jaco2_target())
    page = shown(solutions).page
    assert drawn(page) > 0.02
    rows = page.locator(".postures tbody tr")
    assert rows.count() == len(solutions)
    for k, result in enumerate(solutions):
        page.locator(f"#p{k}").check()
        np.testing.assert_allclose(tip(page), jaco2_target().homogeneous, rtol=0, atol=1e-9)
        text = rows.nth(k).inner_text()
        assert result.branch in text
        assert ("outside" in text) == (not result.solved)
        assert "from its target" in page.locator(".residuals").inner_text()


def test_a_target_out_of_reach_is_drawn_with_what_is_missing(shown: Show) -> None:
    nao = robot("nao")
    arm = nao.chain("left_arm")
    result = nk.solve(arm, [0.4, 0.3, 0.2])
    page = shown(result).page
    assert drawn(page) > 0.02
    text = page.locator(".residuals").inner_text()
    assert number(text.split(" is ")[1].split(" mm")[0]) == pytest.approx(1e3 * result.position_error, rel=5e-3)
    assert page.locator(".label.residual >> visible=true").first.inner_text().endswith("mm")
    drive(page, nao.joint_names, {"LShoulderPitch": 1.0, "LElbowRoll": -1.0})
    q = arm.q_of({**nao.neutral, **result.posture, "LShoulderPitch": 1.0, "LElbowRoll": -1.0})
    missing = np.linalg.norm(arm.pose(q).translation - [0.4, 0.3, 0.2])
    text = page.locator(".residuals").inner_text()
    assert number(text.split(" is ")[1].split(" mm")[0]) == pytest.approx(1e3 * missing, rel=5e-3)


@pytest.mark.parametrize(
    "target",
    [
        nk.Target.pose(from_xyz_rpy((0.2, -0.3, 0.4), (3.0, -1.2, 0.4)), {"rz": 0}),
        nk.Target.orientation(from_xyz_rpy((0, 0, 0), (np.pi, 0.0, 0.0)).rotation),
        nk.Target.pointing([0.2, -0.3, 0.4], [1, 2, 3], [0, 0, 1]),
    ],
)
def test_the_residual_is_the_judges(shown: Show, target: nk.Target) -> None:
    arm = robot("jaco2").chain("arm")
    page = shown(nk.solve(arm, target)).page
    start = np.array([0.3, 2.5, 1.5, 0.4, 0.5, 0.6])
    drive(page, robot("jaco2").joint_names, dict(zip(arm.joint_names, start.tolist(), strict=True)))
    residual = page.evaluate("() => naoKin.goals[0].residual(naoKin.state)")
    # The judge's own measure of the same joints: a budget of no iteration leaves them where they are.
    from nao_kin.ik.problem import Problem, Run, Status, judge

    measured = judge(Problem(arm, target), Run(start.copy(), Status.STALLED))
    for mine, its in ((residual["position"], measured.position_error), (residual["rotation"], measured.rotation_error)):
        assert (mine is None) == (its is None)
        if its is not None:
            assert np.linalg.norm(mine) == pytest.approx(its, abs=1e-9)


def wave_trajectory() -> nk.Trajectory:
    arm = robot("nao").chain("left_arm")
    times = np.linspace(0.0, 2.0, 41)
    q = np.column_stack([0.6 + 0.2 * np.sin(times + k) for k in range(len(arm.joints))])
    q[:, 3] = -0.7 + 0.3 * np.sin(2 * times)
    return nk.Trajectory(arm.joints, times, q, "wave")


def test_a_trajectory_plays_and_is_scrubbed(shown: Show) -> None:
    nao, trajectory = robot("nao"), wave_trajectory()
    page = shown(nao, trajectory).page
    assert drawn(page) > 0.02
    for time in (0.0, 0.333, 1.99, 2.0):
        slide(page, "#scrub", time)
        posture = dict(zip(trajectory.joint_names, trajectory.at(time).tolist(), strict=True))
        expected = nao.pose(nao.complete(posture), "LArm", "torso").homogeneous
        page.locator("#chain").select_option("left_arm")
        np.testing.assert_allclose(tip(page), expected, rtol=0, atol=1e-8)
    slide(page, "#scrub", 0.0)
    before = pixels(page)
    page.keyboard.press(" ")
    page.wait_for_function("() => naoKin.player.time > 0.2", timeout=20_000)
    page.wait_for_function("() => !naoKin.player.playing", timeout=30_000)
    assert page.evaluate("() => naoKin.player.time") == 2.0
    assert (np.abs(before - pixels(page)).max(axis=2) > 12).sum() > 100
    page.locator("#play").click()
    assert page.evaluate("() => naoKin.player.playing")
    drive(page, nao.joint_names, {"HeadYaw": 0.2})  # a hand on a slider stops it
    assert not page.evaluate("() => naoKin.player.playing")


def test_a_walk_moves_the_body_and_leaves_the_standing_feet_where_they_are(shown: Show) -> None:
    phantomx = robot("phantomx")
    walked = walk(phantomx, WalkCommand(gait="ripple", velocity=(0.05, 0.0), turn=0.2, duration=2.0))
    page = shown(phantomx, walked).page
    assert drawn(page) > 0.005
    feet = [f"leg_{leg}" for leg in LEGS]
    chains = page.evaluate("() => naoKin.state.scene.chains.map(({ name, tip }) => [name, tip])")
    tips = [dict(chains)[name] for name in feet]
    start = np.linalg.inv(walked.T_world_body[0])
    for sample in (0, 60, 123, len(walked.attempt) - 1):
        slide(page, "#scrub", float(walked.attempt.times[sample]))
        found = page.evaluate("(tips) => tips.map((tip) => naoKin.state.world[tip].slice(12, 15))", tips)
        expected = walked.feet[sample] @ start[:3, :3].T + start[:3, 3]
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-7)
    moved = page.evaluate("() => naoKin.state.body.slice(12, 15)")
    assert np.linalg.norm(moved) > 0.03
    with pytest.raises(nk.NaoKinError, match="walk: expected one that can be walked"):
        shown(phantomx, walk(phantomx, WalkCommand(velocity=(0.6, 0.0), duration=1.0)))


def test_the_curves_show_values_speeds_and_limits(shown: Show) -> None:
    page = shown(robot("nao"), wave_trajectory()).page
    assert page.locator("#curves .curve").count() == 2 * 5
    page.locator("#curve-joint").select_option("LElbowRoll")
    assert page.locator("#curves .curve").count() == 2
    assert page.locator("#curves .bound").count() == 4
    page.locator("#fold").click()
    assert page.locator("#curves .curve >> visible=true").count() == 0


def test_a_run_of_a_solver_shows_its_iterates_and_errors(shown: Show) -> None:
    arm = robot("jaco2").chain("arm")
    result = nk.solve(arm, arm.pose([3.5, 2.5, 1.5, 0.4, 0.5, 0.6]), trace=True)
    assert result.trace is not None
    page = shown(result).page
    assert drawn(page) > 0.005  # a thin arm, beside the path of its tip
    assert page.locator("#curves .curve").count() == 2
    assert page.get_by_text("The target is reached").is_visible()
    for k in (0, 3, len(result.trace.q) - 1):
        slide(page, "#scrub", k)
        np.testing.assert_allclose(tip(page), arm.pose(result.trace.q[k]).homogeneous, rtol=0, atol=1e-8)
        residual = page.evaluate("() => naoKin.goals[0].residual(naoKin.state)")
        assert np.linalg.norm(residual["position"]) == pytest.approx(result.trace.position_error[k], abs=1e-8)


def test_a_comparison_moves_both_chains_and_measures_their_gap(shown: Show) -> None:
    model = robot("nao_v50_h21")
    found = nk.compare(nk.document_chain("thesis_left_arm"), model.chain("left_arm"), samples=50)
    page = shown(found, explain=True).page
    assert page.get_by_text("Orange: thesis_left_arm").is_visible()
    page.get_by_text("Explanation").click()
    assert page.get_by_text("modified convention").first.is_visible()
    picture = pixels(page)
    red, green, blue = picture[..., 0], picture[..., 1], picture[..., 2]
    assert ((red - blue > 80) & (red - green > 30)).sum() > 300  # orange and red sticks
    assert ((blue - red > 60) & (blue - green > 30)).sum() > 300  # blue ones
    labels = page.locator(".label.residual >> visible=true").all_inner_texts()
    assert f"{1e3 * found.max_position_error:.0f} mm" in labels
    q = np.array([0.3, 0.2, -0.5, -0.8])
    drive(page, model.joint_names, dict(zip(found.b.joint_names, q.tolist(), strict=True)))
    for index, chain in ((0, found.a), (1, found.b)):
        page.locator("#chain").select_option(str(index))
        np.testing.assert_allclose(tip(page), chain.pose(q).homogeneous, rtol=0, atol=1e-12)
        np.testing.assert_allclose(tip_shown(page)[:3], chain.pose(q).translation, rtol=0, atol=1e-6)


AXES = ("x", "y", "z", "roll", "pitch", "yaw")


def test_a_hexapods_body_moves_over_feet_that_stay(shown: Show, rng: np.random.Generator) -> None:
    model = robot("phantomx")
    legs = {name: model.chain(name) for name in model.chain_frames}
    feet = {name: chain.pose(np.zeros(3)).translation for name, chain in legs.items()}
    page = shown(model).page
    assert drawn(page) > 0.02
    solved = 0
    for _ in range(12):
        page.locator("#level").click()
        pose = np.concatenate([rng.uniform(-0.015, 0.015, 3), rng.uniform(-0.1, 0.1, 3)])
        near = dict.fromkeys(model.joint_names, 0.0)
        slide_all(page, {f"#body-{name}": value for name, value in zip(AXES, pose, strict=True)})
        result = body_ik(legs, from_xyz_rpy(pose[:3], pose[3:]), feet, near=near)
        values = dict(zip(model.joint_names, page.evaluate("() => naoKin.state.values"), strict=True))
        assert (page.locator("#missed p").count() == 0) == result.solved
        if result.solved:
            solved += 1
            for name, expected in result.posture.items():
                assert values[name] == pytest.approx(expected, abs=1e-9), name
    assert 2 < solved < 12  # some legs cannot follow, and then both say so


def test_a_leg_that_cannot_follow_is_red_and_named(shown: Show) -> None:
    model = robot("phantomx")
    legs = {name: model.chain(name) for name in model.chain_frames}
    feet = {name: chain.pose(np.zeros(3)).translation for name, chain in legs.items()}
    page = shown(model).page
    before = pixels(page)
    slide(page, "#body-y", 0.1)
    result = body_ik(legs, from_xyz_rpy((0.0, 0.1, 0.0), (0, 0, 0)), feet)
    missed = {one.leg.removeprefix("leg_").upper(): one for one in result.missed}
    assert missed
    told = page.locator("#missed p").all_inner_texts()
    assert sorted(text.split()[1] for text in told) == sorted(missed)
    for text in told:
        one = missed[text.split()[1]]
        assert ("limits" in text) == (one.reason == "limits")
        if one.reason != "limits":
            assert one.reason in text
            assert number(text.split(" is ")[1].split(" mm")[0]) == pytest.approx(1e3 * one.misses_by, rel=5e-3)
    card = 360
    red = [(p[:, card:, 0] - p[:, card:, 1:].max(axis=2) > 80).sum() for p in (before, pixels(page))]
    assert red[1] > red[0] + 5000
    page.locator("#level").click()
    assert page.locator("#missed p").count() == 0


def test_a_table_alone_is_a_stick_figure(shown: Show) -> None:
    table = nk.document_chain("practicum_jaco2")
    page = shown(table).page
    assert drawn(page) > 0.0005
    q = [0.3, 2.5, 1.5, 0.4, 0.5, 0.6]
    slide_all(page, {f"#j{k}": value for k, value in enumerate(q)})
    np.testing.assert_allclose(tip(page), table.pose(q).homogeneous, rtol=0, atol=1e-12)
