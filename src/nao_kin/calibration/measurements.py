"""What was measured of a robot: kinds of rows, each with the joints it was taken at, its values and its noise.

Every kind compares what the tip should be with what it is. Its residuals are in units of their noise, and their
derivatives are by the twist of the tip (velocity of its origin, angular velocity, in world axes) and by what is unknown
beside the robot, as where a socket is.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import numpy as np
import pinocchio as pin

from nao_kin.arrays import positive, rows, vector
from nao_kin.errors import InvalidInputError
from nao_kin.se3 import as_pose

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import ArrayLike, NDArray

    from nao_kin.arrays import Floats
    from nao_kin.se3 import PoseLike

__all__ = ["Block", "Measurements", "SeenRows"]

_MILLIMETRE, _MILLIRADIAN, _PIXEL = 1e-3, 1e-3, 1.0
_RIGID: Final = 2e-5  # [m] noise of what is known without measuring, as the distance of two holes in one plate


class SeenRows(NamedTuple):
    """Residuals of a block and what they depend on.

    Attributes:
        residuals: (R, d), in units of their noise.
        terms: For each role of the joints: which of the block's joints each row uses (R,), and the derivative of the
            residuals by the twist of the tip there (R, d, 6).
        unknown: Derivative by the block's own unknowns (R, d, k).
    """

    residuals: Floats
    terms: tuple[tuple[NDArray[np.intp], Floats], ...]
    unknown: Floats


@dataclass(frozen=True, eq=False)
class Block:
    """Rows of one kind.

    Attributes:
        Q: The joints (M, n) [rad or m].
        noise: Standard deviations of a row's values (d,), in their units.
        tip: Which tip of a tree it is about; None for a chain.
        place: A label a row (R,): rows of one label are held out together.
        names: Names of the joints in the columns of Q, where they are known; empty otherwise.
        frees: Whose placements are unknown: ``"base"``, ``"tool"``.
    """

    Q: Floats
    noise: Floats
    tip: str | None = None
    place: tuple[str, ...] = ()
    names: tuple[str, ...] = ()
    frees: frozenset[str] = frozenset()

    kind = "rows"
    unit = "m"

    @property
    def unknown_names(self) -> tuple[str, ...]:
        """What is unknown beside the robot, one name a number."""
        return ()

    @property
    def rows(self) -> int:
        """How many rows there are."""
        return len(self.Q)

    def start(self, T: Floats) -> Floats:  # noqa: ARG002
        """First values (k,) of the block's own unknowns, from poses (M, 4, 4) of the tip."""
        return np.zeros(0)

    def seen(self, T: Floats, y: Floats) -> SeenRows:
        """Residuals at poses (M, 4, 4) of the tip and unknowns y (k,)."""
        raise NotImplementedError

    def distances(self, T: Floats, y: Floats) -> Floats:
        """How far off each row is (R,), in `unit`."""
        residuals = self.seen(T, y).residuals * self.noise
        return np.asarray(np.linalg.norm(residuals[:, :3], axis=1))

    def taken(self, keep: NDArray[np.bool_]) -> Block:
        """The rows (R,) that are kept."""
        picked = {name: getattr(self, name)[keep] for name in self._by_row()}
        place = tuple(label for label, kept in zip(self.place, keep.tolist(), strict=True) if kept)
        return replace(self, **picked, place=place)

    def _by_row(self) -> tuple[str, ...]:
        return ("Q",)


@dataclass(frozen=True, eq=False)
class MeasuredPoses(Block):
    """MeasuredPoses of a marker on the tip, in the world.

    Attributes:
        measured: (R, 4, 4).
        marker: The marker on the tip (4, 4).
    """

    measured: Floats = field(default_factory=lambda: np.zeros((0, 4, 4)))
    marker: Floats = field(default_factory=lambda: np.eye(4))
    kind = "poses"

    def seen(self, T: Floats, y: Floats) -> SeenRows:  # noqa: ARG002 (nothing is unknown beside the robot)
        """Position and rotation that are missing, in world axes."""
        at = T @ self.marker
        turn = np.array([pin.log3(M[:3, :3] @ R[:3, :3].T) for M, R in zip(self.measured, at, strict=True)])
        residuals = np.hstack([self.measured[:, :3, 3] - at[:, :3, 3], turn.reshape(-1, 3)])
        D = np.zeros((len(T), 6, 6))
        D[:, :3] = -_moves_point(T, self.marker[:3, 3])
        D[:, 3:, 3:] = [-pin.Jlog3(pin.exp3(e)) for e in turn]
        return _whitened(residuals, ((np.arange(len(T)), D),), np.zeros((len(T), 6, 0)), self.noise)

    def _by_row(self) -> tuple[str, ...]:
        return ("Q", "measured")


@dataclass(frozen=True, eq=False)
class MeasuredPositions(Block):
    """Places of a point on the tip, in the world.

    Attributes:
        measured: (R, 3) [m].
        point: The point in the tip's frame (3,) [m].
    """

    measured: Floats = field(default_factory=lambda: np.zeros((0, 3)))
    point: Floats = field(default_factory=lambda: np.zeros(3))
    kind = "positions"

    def seen(self, T: Floats, y: Floats) -> SeenRows:  # noqa: ARG002 (nothing is unknown beside the robot)
        """Position that is missing, in world axes."""
        residuals = self.measured - _points(T, self.point)
        terms = ((np.arange(len(T)), -_moves_point(T, self.point)),)
        return _whitened(residuals, terms, np.zeros((len(T), 3, 0)), self.noise)

    def _by_row(self) -> tuple[str, ...]:
        return ("Q", "measured")


@dataclass(frozen=True, eq=False)
class SamePoints(Block):
    """The tip is at one of several unknown points, whose distances may be known.

    Attributes:
        group: Which point each row is at (R,).
        between: Pairs of points whose distance is known, (a, b, distance [m]).
        rigid: Noise of these distances [m].
    """

    group: NDArray[np.intp] = field(default_factory=lambda: np.zeros(0, dtype=np.intp))
    between: tuple[tuple[int, int, float], ...] = ()
    rigid: float = _RIGID
    kind = "same points"

    @property
    def unknown_names(self) -> tuple[str, ...]:
        """Coordinates of the points."""
        return tuple(f"{axis} of point {k}" for k in range(int(self.group.max(initial=-1)) + 1) for axis in "xyz")

    def start(self, T: Floats) -> Floats:
        """The means of the tips; at a point that no row is at, the mean of all."""
        tips, count = T[:, :3, 3], int(self.group.max(initial=-1)) + 1
        means = [
            tips[self.group == k].mean(axis=0) if (self.group == k).any() else tips.mean(axis=0) for k in range(count)
        ]
        return np.concatenate(means) if means else np.zeros(0)

    def seen(self, T: Floats, y: Floats) -> SeenRows:
        """From each point to its tips; and, as rows without joints, what distances of points are off by."""
        N, extra, points = len(T), len(self.between), y.reshape(-1, 3)
        residuals, unknown = np.zeros((N + extra, 3)), np.zeros((N + extra, 3, len(y)))
        residuals[:N] = T[:, :3, 3] - points[self.group]
        for axis in range(3):
            unknown[np.arange(N), axis, 3 * self.group + axis] = -1.0
        D = np.zeros((N, 3, 6))
        D[:, :, :3] = np.eye(3)
        D /= self.noise[:, None]
        residuals[:N] /= self.noise
        unknown[:N] /= self.noise[:, None]
        for row, (a, b, distance) in enumerate(self.between, start=N):
            apart = points[b] - points[a]
            length = max(float(np.linalg.norm(apart)), 1e-12)
            residuals[row, 0] = (length - distance) / self.rigid
            unknown[row, 0, 3 * b : 3 * b + 3] = apart / length / self.rigid
            unknown[row, 0, 3 * a : 3 * a + 3] = -apart / length / self.rigid
        return SeenRows(residuals, ((np.arange(N), D),), unknown)

    def distances(self, T: Floats, y: Floats) -> Floats:  # noqa: ARG002 (nothing is unknown beside the robot)
        """From each tip to the mean of the tips that should be with it."""
        means = np.array([T[self.group == k, :3, 3].mean(axis=0) for k in self.group])
        return np.asarray(np.linalg.norm(T[:, :3, 3] - means.reshape(-1, 3), axis=1))

    def taken(self, keep: NDArray[np.bool_]) -> Block:
        """The rows that are kept; points that none is left of go, and their distances with them."""
        left, group = np.unique(self.group[keep], return_inverse=True)
        number = {int(old): new for new, old in enumerate(left)}
        between = tuple((number[a], number[b], d) for a, b, d in self.between if a in number and b in number)
        made = super().taken(keep)
        return replace(made, group=group.astype(np.intp), between=between)  # type: ignore[call-arg]

    def _by_row(self) -> tuple[str, ...]:
        return ("Q", "group")


@dataclass(frozen=True, eq=False)
class Distances(Block):
    """Distances between places of the tip: rows 2k and 2k + 1 of Q belong together.

    Attributes:
        measured: (R,) [m].
    """

    measured: Floats = field(default_factory=lambda: np.zeros(0))
    kind = "distances"

    @property
    def rows(self) -> int:
        """Half as many as joints."""
        return len(self.measured)

    def seen(self, T: Floats, y: Floats) -> SeenRows:  # noqa: ARG002 (nothing is unknown beside the robot)
        """By how much the distance is too small."""
        first, second = np.arange(0, len(T), 2), np.arange(1, len(T), 2)
        apart = T[second, :3, 3] - T[first, :3, 3]
        length = np.maximum(np.linalg.norm(apart, axis=1), 1e-12)
        D = np.zeros((len(first), 1, 6))
        D[:, 0, :3] = -apart / length[:, None]
        residuals = (self.measured - length)[:, None]
        return _whitened(residuals, ((second, D), (first, -D)), np.zeros((len(first), 1, 0)), self.noise)

    def taken(self, keep: NDArray[np.bool_]) -> Block:
        """The pairs that are kept."""
        place = tuple(label for label, kept in zip(self.place, keep.tolist(), strict=True) if kept)
        return replace(self, Q=self.Q[np.repeat(keep, 2)], measured=self.measured[keep], place=place)


@dataclass(frozen=True, eq=False)
class TouchedPlane(Block):
    """The tip touches a plane.

    Attributes:
        known: Unit normal and height along it (4,) [1, m]; None if the plane is unknown.
    """

    known: Floats | None = None
    kind = "plane"

    @property
    def unknown_names(self) -> tuple[str, ...]:
        """Normal and height of an unknown plane: the normal's length counts for nothing."""
        return () if self.known is not None else ("normal x", "normal y", "normal z", "height")

    def start(self, T: Floats) -> Floats:
        """The plane through the tips."""
        if self.known is not None:
            return np.zeros(0)
        tips = T[:, :3, 3]
        normal = np.linalg.svd(tips - tips.mean(axis=0))[2][-1]
        return np.array([*normal, float(normal @ tips.mean(axis=0))])

    def seen(self, T: Floats, y: Floats) -> SeenRows:
        """Height of the tips over the plane."""
        normal, height = (self.known[:3], self.known[3]) if self.known is not None else (y[:3], y[3])
        length = float(np.linalg.norm(normal))
        n = normal / length
        residuals = (T[:, :3, 3] @ n - height)[:, None]
        D = np.zeros((len(T), 1, 6))
        D[:, 0, :3] = n
        unknown = np.zeros((len(T), 1, len(y)))
        if self.known is None:
            across = (np.eye(3) - np.outer(n, n)) / length
            unknown[:, 0, :3] = T[:, :3, 3] @ across
            unknown[:, 0, 3] = -1.0
        return _whitened(residuals, ((np.arange(len(T)), D),), unknown, self.noise)


@dataclass(frozen=True, eq=False)
class Sightings(Block):
    """Where a point appears in the picture of a pinhole camera, on the tip or beside the robot.

    Attributes:
        measured: (R, 2) [px].
        focal: Focal lengths (2,) [px].
        centre: Principal point (2,) [px].
        camera: The camera, z forwards, x right, y down: on the tip, or in the world if `beside`; (4, 4).
        beside: Whether the camera stands in the world and the point is on the tip.
        point: The point, in the world or, if `beside`, on the tip (3,) [m]; None if it is unknown.
    """

    measured: Floats = field(default_factory=lambda: np.zeros((0, 2)))
    focal: Floats = field(default_factory=lambda: np.ones(2))
    centre: Floats = field(default_factory=lambda: np.zeros(2))
    camera: Floats = field(default_factory=lambda: np.eye(4))
    beside: bool = False
    point: Floats | None = None
    kind, unit = "sightings", "px"

    @property
    def unknown_names(self) -> tuple[str, ...]:
        """Coordinates of the point."""
        return ("x of the point", "y of the point", "z of the point") if self.point is None else ()

    def start(self, T: Floats) -> Floats:
        """The point nearest to all rays of an unknown point."""
        if self.point is not None:
            return np.zeros(0)
        if self.beside:
            return np.zeros(3)
        at = T @ self.camera
        rays = np.hstack([(self.measured - self.centre) / self.focal, np.ones((len(T), 1))])
        rays /= np.linalg.norm(rays, axis=1, keepdims=True)
        rays = np.einsum("nij,nj->ni", at[:, :3, :3], rays)
        across = np.eye(3) - rays[:, :, None] * rays[:, None, :]
        found: Floats = np.linalg.lstsq(across.sum(axis=0), np.einsum("nij,nj->i", across, at[:, :3, 3]), rcond=None)[0]
        return found

    def seen(self, T: Floats, y: Floats) -> SeenRows:
        """How far the picture's point is from the seen one."""
        point = y[:3] if self.point is None else self.point
        N = len(T)
        if self.beside:
            R, p = self.camera[:3, :3], self.camera[:3, 3]
            local = (_points(T, point) - p) @ R
            moves = np.einsum("ji,njk->nik", R, _moves_point(T, point))
            by_point = np.einsum("ji,njk->nik", R, T[:, :3, :3])
        else:
            at = T @ self.camera
            R_t = np.swapaxes(at[:, :3, :3], 1, 2)
            local = np.einsum("nij,nj->ni", R_t, point - at[:, :3, 3])
            # The world moves past the camera: −v − ω × (x − p_tip).
            still = np.zeros((N, 3, 6))
            still[:, :, :3] = -np.eye(3)
            still[:, :, 3:] = _cross(point - T[:, :3, 3])
            moves, by_point = np.einsum("nij,njk->nik", R_t, still), R_t
        depth = np.where(np.abs(local[:, 2]) > 1e-9, local[:, 2], 1e-9)
        residuals = self.measured - (self.focal * local[:, :2] / depth[:, None] + self.centre)
        P = np.zeros((N, 2, 3))
        P[:, 0, 0], P[:, 1, 1] = self.focal[0] / depth, self.focal[1] / depth
        P[:, :, 2] = -self.focal * local[:, :2] / depth[:, None] ** 2
        unknown = -P @ by_point if self.point is None else np.zeros((N, 2, 0))
        return _whitened(residuals, ((np.arange(N), -P @ moves),), unknown, self.noise)

    def _by_row(self) -> tuple[str, ...]:
        return ("Q", "measured")


@dataclass(frozen=True, eq=False)
class Measurements:
    """Rows of several kinds; add two to have all of both.

    Make them with `poses`, `positions`, `same_points`, `distances`, `plane`, `sightings`, or `from_csv`.

    Attributes:
        blocks: The rows by kind.
    """

    blocks: tuple[Block, ...] = ()

    def __add__(self, other: Measurements) -> Measurements:
        if not isinstance(other, Measurements):
            return NotImplemented
        return Measurements((*self.blocks, *other.blocks))

    def __len__(self) -> int:
        return sum(block.rows for block in self.blocks)

    def __repr__(self) -> str:
        kinds = ", ".join(f"{block.rows} {block.kind}" for block in self.blocks)
        return f"<Measurements: {kinds or 'none'}>"

    @classmethod
    def poses(
        cls,
        Q: ArrayLike,
        poses: Any,
        *,
        noise: tuple[float, float] = (_MILLIMETRE, _MILLIRADIAN),
        base_known: bool = True,
        marker: PoseLike | None = None,
        marker_known: bool = True,
        tip: str | None = None,
        place: str = "",
    ) -> Measurements:
        """MeasuredPoses of a marker on the tip, as a tracker or another limb sees them.

        Args:
            Q: Joints (N, n) [rad or m].
            poses: T_world_marker (N, 4, 4).
            noise: Standard deviations [m], [rad].
            base_known: Whether the world is the chain's base frame; otherwise where the base is, is estimated as well.
            marker: T_tip_marker; the tip itself by default.
            marker_known: Whether `marker` is exact; otherwise it is a guess, and estimated as well.
            tip: The tip of a tree that it is about.
            place: Rows of one label are held out together when a fit is validated.

        Raises:
            InvalidInputError: Shapes that do not fit, not finite, or no poses.
        """
        joints = _joints(Q)
        given = np.array([as_pose(T, f"pose {k}").homogeneous for k, T in enumerate(poses)]).reshape(-1, 4, 4)
        _same_length(joints, given, "poses")
        frees = _frees(base_known, marker_known)
        M = np.eye(4) if marker is None else as_pose(marker, "marker").homogeneous
        six = np.repeat([positive(n, "noise", "[m], [rad]") for n in noise], 3)
        return cls((MeasuredPoses(joints, six, tip, (place,) * len(joints), frees=frees, measured=given, marker=M),))

    @classmethod
    def positions(
        cls,
        Q: ArrayLike,
        positions: ArrayLike,
        *,
        noise: float = _MILLIMETRE,
        base_known: bool = True,
        point: ArrayLike = (0.0, 0.0, 0.0),
        point_known: bool = True,
        tip: str | None = None,
        place: str = "",
    ) -> Measurements:
        """Places (N, 3) [m] of a point on the tip; see `poses` for the other arguments.

        Args:
            Q: Joints (N, n) [rad or m].
            positions: Places in the world (N, 3) [m].
            noise: Standard deviation of a coordinate [m].
            base_known: Whether the world is the chain's base frame.
            point: The point in the tip's frame (3,) [m].
            point_known: Whether it is exact; otherwise a guess, and estimated as well.
            tip: The tip of a tree that it is about.
            place: Rows of one label are held out together when a fit is validated.

        Raises:
            InvalidInputError: Shapes that do not fit, or not finite.
        """
        joints, given = _joints(Q), rows(positions, "positions", 3)
        _same_length(joints, given, "positions")
        at = vector(point, "point", 3)
        noises = np.full(3, positive(noise, "noise", "[m]"))
        frees = _frees(base_known, point_known)
        return cls(
            (MeasuredPositions(joints, noises, tip, (place,) * len(joints), frees=frees, measured=given, point=at),)
        )

    @classmethod
    def same_points(
        cls,
        groups: Sequence[ArrayLike],
        *,
        distances: Mapping[tuple[int, int], float] | None = None,
        noise: float = _MILLIMETRE,
        tip: str | None = None,
        place: str = "",
    ) -> Measurements:
        """The tip is at one unknown point a group: a ball in a socket, or one tip that touches another.

        Args:
            groups: Joints (N_k, n) [rad or m] of each point.
            distances: Known distances [m] between points, by their numbers: ``{(0, 1): 0.05}``.
            noise: Standard deviation of a coordinate [m].
            tip: The tip of a tree that it is about.
            place: Rows of one label are held out together when a fit is validated.

        Raises:
            InvalidInputError: No group, one of fewer than two rows, or a distance between points that do not exist.
        """
        parts = [_joints(group, f"group {k}") for k, group in enumerate(groups)]
        if not parts or any(len(part) < 2 for part in parts):
            raise InvalidInputError(
                "groups", "groups of at least two rows of joints", f"{[len(part) for part in parts]} rows"
            )
        between = []
        for (a, b), length in (distances or {}).items():
            if not (0 <= a < len(parts) and 0 <= b < len(parts)) or a == b:
                raise InvalidInputError("distances", f"two different points of 0 to {len(parts) - 1}", f"{(a, b)}")
            between.append((int(a), int(b), positive(length, f"distance of points {a} and {b}", "[m]")))
        group = np.repeat(np.arange(len(parts)), [len(part) for part in parts])
        Q = np.concatenate(parts)
        noises = np.full(3, positive(noise, "noise", "[m]"))
        return cls((SamePoints(Q, noises, tip, (place,) * len(Q), group=group, between=tuple(between)),))

    @classmethod
    def distances(
        cls,
        Q_from: ArrayLike,
        Q_to: ArrayLike,
        distances: ArrayLike,
        *,
        noise: float = _MILLIMETRE,
        tip: str | None = None,
        place: str = "",
    ) -> Measurements:
        """Distances between the tip's places at two rows of joints.

        Args:
            Q_from: Joints (N, n) [rad or m] at one end.
            Q_to: Joints (N, n) [rad or m] at the other.
            distances: What lies between (N,) [m].
            noise: Standard deviation of a distance [m].
            tip: The tip of a tree that it is about.
            place: Rows of one label are held out together when a fit is validated.

        Raises:
            InvalidInputError: Shapes that do not fit, or not finite.
        """
        first, second = _joints(Q_from, "Q_from"), _joints(Q_to, "Q_to")
        given = rows(np.reshape(np.asarray(distances), (-1, 1)), "distances", 1)[:, 0]
        _same_length(first, second, "Q_to")
        _same_length(first, given, "distances")
        Q = np.stack([first, second], axis=1).reshape(-1, first.shape[1])
        noises = np.array([positive(noise, "noise", "[m]")])
        return cls((Distances(Q, noises, tip, (place,) * len(given), measured=given),))

    @classmethod
    def plane(
        cls,
        Q: ArrayLike,
        *,
        normal: ArrayLike | None = None,
        height: float = 0.0,
        noise: float = _MILLIMETRE,
        tip: str | None = None,
        place: str = "",
    ) -> Measurements:
        """The tip touches a plane.

        Args:
            Q: Joints (N, n) [rad or m].
            normal: Its normal (3,) in the world, of any length; None if the plane is unknown.
            height: Its height along the normal [m].
            noise: Standard deviation of a row [m].
            tip: The tip of a tree that it is about.
            place: Rows of one label are held out together when a fit is validated.

        Raises:
            InvalidInputError: Not finite, or a normal of no length.
        """
        joints, known = _joints(Q), None
        if normal is not None:
            n = vector(normal, "normal", 3)
            length = float(np.linalg.norm(n))
            if length == 0.0:
                raise InvalidInputError("normal", "a direction", "no length")
            known = np.array([*(n / length), height])
        noises = np.array([positive(noise, "noise", "[m]")])
        return cls((TouchedPlane(joints, noises, tip, (place,) * len(joints), known=known),))

    @classmethod
    def sightings(
        cls,
        Q: ArrayLike,
        pixels: ArrayLike,
        *,
        intrinsics: tuple[float, float, float, float],
        camera: PoseLike | None = None,
        beside: bool = False,
        point: ArrayLike | None = None,
        noise: float = _PIXEL,
        tip: str | None = None,
        place: str = "",
    ) -> Measurements:
        """Pictures (N, 2) [px] of a point by a pinhole camera.

        Args:
            Q: Joints (N, n) [rad or m].
            pixels: Where the point appears (N, 2) [px].
            intrinsics: Focal lengths and principal point (fx, fy, cx, cy) [px].
            camera: The camera's frame, z forwards, x right, y down: on the tip, or in the world if `beside`.
            beside: Whether the camera stands beside the robot and looks at a point of its tip.
            point: The point (3,) [m], in the world or, if `beside`, on the tip; unknown by default.
            noise: Standard deviation of a coordinate [px].
            tip: The tip of a tree that it is about.
            place: Rows of one label are held out together when a fit is validated.

        Raises:
            InvalidInputError: Shapes that do not fit, not finite, or no poses.
        """
        joints, given = _joints(Q), rows(pixels, "pixels", 2)
        _same_length(joints, given, "pixels")
        at = None if point is None else vector(point, "point", 3)
        return cls(
            (
                Sightings(
                    joints,
                    np.full(2, positive(noise, "noise", "[px]")),
                    tip,
                    (place,) * len(joints),
                    measured=given,
                    focal=np.array([positive(f, "intrinsics", "[px]") for f in intrinsics[:2]]),
                    centre=vector(intrinsics[2:], "intrinsics", 2),
                    camera=np.eye(4) if camera is None else as_pose(camera, "camera").homogeneous,
                    beside=beside,
                    point=at,
                ),
            )
        )


def _joints(Q: ArrayLike, what: str = "Q") -> Floats:
    array = np.asarray(Q)
    if array.ndim != 2 or not len(array):
        raise InvalidInputError(what, "rows of joints (N, n)", f"shape {array.shape}")
    return rows(array, what, array.shape[1])


def _same_length(Q: Floats, other: Floats, what: str) -> None:
    if len(Q) != len(other):
        raise InvalidInputError(what, f"{len(Q)} rows, as many as joints", f"{len(other)}")


def _frees(base_known: bool, tool_known: bool) -> frozenset[str]:
    return frozenset(([] if base_known else ["base"]) + ([] if tool_known else ["tool"]))


def _whitened(
    residuals: Floats, terms: tuple[tuple[NDArray[np.intp], Floats], ...], unknown: Floats, noise: Floats
) -> SeenRows:
    by = noise[:, None]
    return SeenRows(residuals / noise, tuple((index, D / by) for index, D in terms), unknown / by)


def _points(T: Floats, point: Floats) -> Floats:
    found: Floats = T[:, :3, :3] @ point + T[:, :3, 3]
    return found


def _moves_point(T: Floats, point: Floats) -> Floats:
    """Velocity of a point of the tip by its twist (N, 3, 6)."""
    D = np.zeros((len(T), 3, 6))
    D[:, :, :3] = np.eye(3)
    D[:, :, 3:] = -_cross(T[:, :3, :3] @ point)
    return D


def _cross(v: Floats) -> Floats:
    """Matrices (N, 3, 3) of the cross products with vectors (N, 3)."""
    M = np.zeros((len(v), 3, 3))
    M[:, 0, 1], M[:, 0, 2], M[:, 1, 2] = -v[:, 2], v[:, 1], -v[:, 0]
    M[:, 1, 0], M[:, 2, 0], M[:, 2, 1] = v[:, 2], -v[:, 1], v[:, 0]
    return M
