"""Distances against closed-form certificates, levers as a law, and which pairs are left out."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

import nao_kin as nk
from nao_kin.chain import random_configurations
from nao_kin.collision import DISTANCE_ACCURACY, CollisionModel, Plane
from nao_kin.errors import InvalidInputError, UnknownNameError
from nao_kin.se3 import from_xyz_rpy
from nao_kin.urdf.elements import Box, Cylinder, Sphere
from tests.collision.certificate import depth_outside, gap, support
from tests.conftest import robot

FLOOR = {"nao": -0.34, "jaco2": 0.0, "phantomx": -0.12}


def model(name, **options):
    options.setdefault("planes", [Plane("floor", offset=FLOOR[name])])
    return CollisionModel(robot(name), **options)


def solids_of(name, posture):
    """(link, shape, pose in the root frame) of every collision shape."""
    poses = robot(name).link_poses(posture)
    return [
        (link.name, solid.shape, (poses[link.name] * from_xyz_rpy(solid.origin.xyz, solid.origin.rpy)).homogeneous)
        for link in robot(name).document.links
        for solid in link.collisions
    ]


def chain_of_balls(*, middle=0.05, ends=0.05, limit=3.0, collision=True):
    """Three links in a row, 0.2 m apart, each a ball on its joint's axis; the joints turn about z."""
    shape = '<collision><geometry><sphere radius="{}"/></geometry></collision>' if collision else ""
    links = [f'<link name="l{i}">{shape.format(r)}</link>' for i, r in enumerate((ends, middle, ends))]
    joint = (
        '<joint name="j{0}" type="revolute"><parent link="l{0}"/><child link="l{1}"/><origin xyz="0.2 0 0"/>'
        '<axis xyz="0 0 1"/><limit lower="-{2}" upper="{2}" velocity="1" effort="1"/></joint>'
    )
    return "<robot name='balls'>" + "".join(links) + "".join(joint.format(i, i + 1, limit) for i in (0, 1)) + "</robot>"


def loaded(tmp_path, text):
    path = tmp_path / "robot.urdf"
    path.write_text(text, encoding="utf-8")
    return nk.load(path)


@pytest.mark.parametrize("name", ["nao", "jaco2", "phantomx"])
def test_every_distance_is_certified_from_both_sides(name, rng):
    collisions = model(name)
    plane = collisions.planes[0]
    certified = 0
    for q in random_configurations(collisions.motors, 4, rng):
        posture = collisions.motors.posture(q)
        solids = solids_of(name, posture)
        for found in collisions.distances(posture):
            if found.distance <= 1e-3:
                continue
            between = found.second_point - found.first_point
            assert np.linalg.norm(between) == pytest.approx(found.distance, abs=2 * DISTANCE_ACCURACY)
            direction = between / np.linalg.norm(between)
            holding = [
                [(shape, T) for link, shape, T in solids if link == owner and depth_outside(shape, T, point) <= 1e-5]
                for owner, point in ((found.first, found.first_point), (found.second, found.second_point))
            ]
            if found.second == plane.name:
                assert plane.normal @ found.second_point == pytest.approx(plane.offset, abs=DISTANCE_ACCURACY)
                slab = max(-support(*first, -plane.normal) - plane.offset for first in holding[0])
            else:
                slab = max(
                    gap(first, second, direction, found.distance - DISTANCE_ACCURACY)
                    for first, second in itertools.product(*holding)
                )
            assert slab >= found.distance - DISTANCE_ACCURACY
            certified += 1
    assert certified > 150


@pytest.mark.parametrize("name", ["nao", "jaco2", "phantomx"])
def test_no_motion_changes_a_distance_by_more_than_its_levers_say(name, rng):
    collisions = model(name)
    Q = random_configurations(collisions.motors, 60, rng)
    ways = rng.normal(size=Q.shape) * 10.0 ** rng.uniform(-3, 0.5, size=(len(Q), 1))
    closest = np.inf
    for q, way in zip(Q, ways, strict=True):
        change = np.abs(collisions.measure(q + way) - collisions.measure(q))
        bound = collisions.levers @ np.abs(way)
        assert (change <= bound + 2 * DISTANCE_ACCURACY).all()
        closest = min(closest, float((bound / np.maximum(change, 1e-6))[change > 1e-3].min(initial=np.inf)))
    assert closest < 3.0  # a bound that nothing comes near to would prove nothing


def test_a_lever_is_the_exact_one_where_it_can_be(tmp_path):
    collisions = CollisionModel(loaded(tmp_path, chain_of_balls()))
    # The last ball is on the second joint's axis, 0.2 m from the first one's.
    assert collisions.pairs == ((0, 2),)
    assert collisions.levers == pytest.approx(np.array([[0.25, 0.05]]), abs=1e-12)


def test_neighbours_are_left_out_and_listed():
    collisions = model("jaco2")
    reasons = {(pair.first, pair.second): pair.reason for pair in collisions.excluded}
    links = ("link_base", *(f"link_{i}" for i in range(1, 7)))
    assert {pair for pair, reason in reasons.items() if reason == "meet in a joint"} == set(itertools.pairwise(links))
    assert reasons["link_base", "floor"] == "nothing moves them against each other"
    watched = {collisions.owners(k) for k in range(len(collisions.pairs))}
    assert ("link_base", "link_6") in watched
    assert ("link_6", "floor") in watched
    assert not watched & set(reasons)
    assert "link_base" in collisions.table()._repr_html_()


def test_links_that_always_touch_are_left_out_and_those_that_sometimes_do_are_not(tmp_path):
    fat = CollisionModel(loaded(tmp_path, chain_of_balls(ends=0.25).replace("3.0", "0.1")), planes=[Plane("floor")])
    assert ("l0", "l2", "always touch") in [(e.first, e.second, e.reason) for e in fat.excluded]
    folding = CollisionModel(loaded(tmp_path, chain_of_balls(ends=0.15)))
    assert [folding.owners(k) for k in range(len(folding.pairs))] == [("l0", "l2")]
    assert folding.touching({"j0": 3.0})
    assert not folding.touching({})


def test_a_plane_that_everything_touches_is_noticed_not_left_out(tmp_path):
    collisions = CollisionModel(loaded(tmp_path, chain_of_balls()), planes=[Plane("lid", offset=10.0)])
    assert {pair.second for pair in collisions.touching({})} == {"lid"}


def test_overlap_is_negative_and_the_margin_counts_as_touching(tmp_path):
    arm = loaded(tmp_path, chain_of_balls(ends=0.1))
    apart = 0.4 - 0.2
    assert CollisionModel(arm).distance({}).distance == pytest.approx(apart, abs=1e-6)
    assert not CollisionModel(arm, margin=apart - 1e-5).touching({})
    assert CollisionModel(arm, margin=apart + 1e-5).touching({})
    folded = CollisionModel(arm).distance({"j0": 3.0})
    centres = 2.0 * 0.2 * np.sin(0.5 * (np.pi - 3.0))  # an isosceles triangle with two sides of 0.2 m
    assert folded.distance == pytest.approx(centres - 0.2, abs=1e-5)
    assert "overlap" in str(folded)


def test_what_is_ignored_is_listed(tmp_path):
    planes = [Plane("floor", offset=-1.0)]
    collisions = CollisionModel(loaded(tmp_path, chain_of_balls()), planes=planes, ignored=[("l2", "l0")])
    assert ("l0", "l2", "ignored on request") in [(e.first, e.second, e.reason) for e in collisions.excluded]


def test_misuse_is_named(tmp_path):
    arm = loaded(tmp_path, chain_of_balls())
    with pytest.raises(UnknownNameError, match="l0"):
        CollisionModel(arm, ignored=[("l0", "l9")])
    with pytest.raises(InvalidInputError, match="margin"):
        CollisionModel(arm, margin=-1.0)
    with pytest.raises(InvalidInputError, match="'l1'"):
        CollisionModel(arm, planes=[Plane("l1")])
    with pytest.raises(InvalidInputError, match="length 0"):
        Plane("floor", (0, 0, 0))
    with pytest.raises(InvalidInputError, match="two bodies"):
        CollisionModel(loaded(tmp_path, chain_of_balls(collision=False)))


def test_meshes_are_refused_with_a_note(tmp_path):
    mesh = '<collision><geometry><mesh filename="x.stl"/></geometry></collision>'
    text = chain_of_balls().replace('<link name="l1">', f'<link name="l1">{mesh}')
    (note,) = CollisionModel(loaded(tmp_path, text)).notes
    assert "l1" in note
    assert "MeshFile" in note


@pytest.mark.parametrize("name", ["nao", "jaco2", "phantomx"])
def test_our_own_robots_are_drawn_of_shapes_that_are_watched(name):
    kinds = {type(solid.shape) for link in robot(name).document.links for solid in link.collisions}
    assert kinds <= {Box, Cylinder, Sphere}
    assert model(name).notes == ()


@pytest.mark.parametrize("size", [1e308, 1e154, 1.0, 1e-200, 1e-307])
def test_a_planes_normal_has_unit_length_whatever_its_size(size):
    assert Plane("table", (size, size, size)).normal == pytest.approx(np.full(3, 1.0 / np.sqrt(3.0)), abs=1e-15)
