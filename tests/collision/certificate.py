"""A proof that two convex shapes are a distance apart, written apart from coal.

Points of the two shapes that are d apart show that they are at most that far from each other; a slab of width d between
the shapes, by their support functions, shows that they are at least that far. Both in closed form.
"""

from __future__ import annotations

import numpy as np

from nao_kin.urdf.elements import Box, Cylinder, Sphere


def support(shape, T, direction):
    """Greatest value of direction · x over a shape at a pose (4, 4)."""
    local = T[:3, :3].T @ direction
    match shape:
        case Box(size):
            reach = 0.5 * np.abs(local) @ np.array(size)
        case Cylinder(radius, length):
            reach = radius * np.hypot(local[0], local[1]) + 0.5 * length * abs(local[2])
        case Sphere(radius):
            reach = radius * np.linalg.norm(local)
    return float(direction @ T[:3, 3] + reach)


def depth_outside(shape, T, point):
    """How far a point is outside a shape, in the shape's own measure (0 inside) [m]."""
    x = T[:3, :3].T @ (point - T[:3, 3])
    match shape:
        case Box(size):
            return float((np.abs(x) - 0.5 * np.array(size)).max(initial=0.0))
        case Cylinder(radius, length):
            return max(0.0, float(np.hypot(x[0], x[1])) - radius, abs(float(x[2])) - 0.5 * length)
        case Sphere(radius):
            return max(0.0, float(np.linalg.norm(x)) - radius)
    raise AssertionError(shape)


def gap(first, second, direction, enough):
    """Width of the widest slab found between two shapes (each with its pose) near a direction between them [m].

    Every direction gives a lower bound of the distance. The given one comes from nearest points, which are known less
    well than their distance, so it is turned until the slab is wide enough.
    """

    def width(n):
        return -support(*second, -n) - support(*first, n)

    best, n = width(direction), direction
    for step in np.geomspace(1e-2, 1e-7, 26):
        if best >= enough:
            break
        tangents = np.linalg.svd(n[None])[2][1:]
        for tangent in (*tangents, *-tangents):
            tried = (n + step * tangent) / np.hypot(1.0, step)
            if width(tried) > best:
                best, n = width(tried), tried
    return best
