"""Calibration: the numbers of a robot that its measurements say, what they are worth, and what they cannot say."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Final, Literal

import numpy as np
import pinocchio as pin

from nao_kin.calibration.chain_model import Model, NumberName, model_of, nominal, placed_by, small_motion
from nao_kin.calibration.fitting import Fit, solved, system_of
from nao_kin.calibration.parameters import chosen, key_of, phrase, unit_of
from nao_kin.errors import InvalidInputError
from nao_kin.robot.robot import Robot
from nao_kin.robot.urdf_chain import UrdfChain
from nao_kin.se3 import from_xyz_rpy, rpy
from nao_kin.table import Column, Table
from nao_kin.urdf import parse_urdf
from nao_kin.urdf.origins import with_origins

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from nao_kin.arrays import Floats
    from nao_kin.calibration.measurements import Measurements
    from nao_kin.dh import DHChain

__all__ = ["Calibration", "Estimate", "calibrate"]

_MOVED: Final = 3.0  # standard deviations
_PART: Final = 1e-6  # of a direction's largest entry: less is rounding
_ALIKE: Final = 1e-9  # [rad, m]


@dataclass(frozen=True, slots=True)
class Estimate:
    """One number of the robot.

    Attributes:
        name: Whose it is, and which.
        value: What the measurements say [m or rad; a ratio has no unit].
        deviation: Its standard deviation, in the directions that the measurements tell.
        verdict: ``"moved"`` (from the nominal value, by more than three deviations), ``"not moved"`` or ``"not seen"``.
        unit: ``"m"``, ``"rad"`` or ``""``.
    """

    name: NumberName
    value: float
    deviation: float
    verdict: Literal["moved", "not moved", "not seen"]
    unit: str


@dataclass(frozen=True, eq=False)
class Calibration:
    """What a calibration found. Immutable.

    Attributes:
        nominal: The chain as it was given.
        model: Its numbers by name.
        measurements: What was measured.
        fit: The least squares behind it.
        noise: How many times larger than said the noise is, by the residuals that are left [1].
    """

    nominal: UrdfChain
    model: Model
    measurements: Measurements
    fit: Fit
    noise: float

    @cached_property
    def estimates(self) -> tuple[Estimate, ...]:
        """The numbers that were asked for, each with its standard deviation and a verdict."""
        slides = {joint.name: joint.slides for joint in self.model.joints}
        deviations = self.noise * np.sqrt(np.maximum(np.diag(self.fit.covariance), 0.0))
        unseen = np.abs(self.fit.unseen).max(axis=1, initial=0.0) > _PART
        found = []
        for k, name in enumerate(self.fit.system.names[: self.fit.system.wanted]):
            value, deviation = float(self.fit.u[k]), float(deviations[k])
            far = abs(value - nominal(name)) > _MOVED * deviation
            verdict: Literal["moved", "not moved", "not seen"] = "moved" if far else "not moved"
            found.append(Estimate(name, value, deviation, "not seen" if unseen[k] else verdict, unit_of(name, slides)))
        return tuple(found)

    @cached_property
    def unidentifiable(self) -> tuple[str, ...]:
        """Directions in which nothing that was measured changes, a sentence each; their number is the nullity."""
        told = []
        for direction in _sparse(self.fit.unseen / self.fit.scale[:, None]):
            names = self.fit.system.names
            parts = [phrase(names[k]) for k in range(len(names)) if abs(direction[k]) > _PART * np.abs(direction).max()]
            if len(parts) == 1:
                told.append(f"{parts[0]} changes nothing that was measured.")
            elif parts:
                told.append(f"{', '.join(parts[:-1])} and {parts[-1]} cannot be told apart.")
        return tuple(sentence[0].upper() + sentence[1:] for sentence in told)

    def to_urdf(self) -> str:
        """The robot's own file, of which only the origins of moved joints are written anew; comments stay.

        Raises:
            InvalidInputError: A ratio, the base or the tool was moved, for which a file of joints has no place; or the
                file has changed since it was read.
        """
        values = self.fit.values
        homeless = [
            key_of(name)
            for name in self.fit.system.names[: self.fit.system.wanted]
            if (name[1] == "ratio" or name[0] in ("base", self.model.tool_name))
            and abs(values[name] - nominal(name)) > _ALIKE
        ]
        if homeless:
            got = f"{', '.join(homeless)} moved"
            raise InvalidInputError("to_urdf", "numbers that stand at joints; .tool and .base have the others", got)
        return with_origins(self.nominal.robot.document, self._origins())

    @property
    def robot(self) -> Robot:
        """The calibrated robot, with the named chains of the nominal one."""
        before, document = self.nominal.robot, parse_urdf(self.to_urdf().encode(), self.nominal.robot.document.path)
        return Robot(
            before.name,
            document,
            chain_frames=before.chain_frames,
            effectors=before.effectors,
            limit_rules=before.limit_rules,
            mesh_roots=before.mesh_roots,
        )

    @cached_property
    def chain(self) -> UrdfChain:
        """The calibrated chain, between the same frames."""
        return self.robot.chain(self.nominal.base, self.nominal.tip)

    @property
    def table(self) -> DHChain:
        """The calibrated chain as a DH table (standard)."""
        from nao_kin.dh.from_chain import to_dh

        return to_dh(self.chain)

    @property
    def tool(self) -> pin.SE3:
        """T_nominal_tip to the calibrated one: what the tool's numbers make."""
        return self._placed(self.model.tool_name)

    @property
    def base(self) -> pin.SE3:
        """T_world_base: what the base's numbers make."""
        return self._placed("base")

    def summary(self) -> str:
        """How well it fits, what moved, and what is not known."""
        moved = [e for e in self.estimates if e.verdict == "moved"]
        lines = [
            f"{len(self.measurements)} rows of {self.nominal.name}; residuals are {self.noise:.3g} times the noise."
        ]
        lines += [f"{_sentence(phrase(e.name))}: {_amount(e)}." for e in moved] or ["Nothing moved."]
        return "\n".join([*lines, *self.unidentifiable])

    def __repr__(self) -> str:
        moved = sum(e.verdict == "moved" for e in self.estimates)
        return f"<Calibration of {self.nominal.name}: {moved} of {len(self.estimates)} numbers moved>"

    def _repr_html_(self) -> str:
        columns = (Column("number"), Column("estimate", number=True), Column("± 1σ", number=True), Column("verdict"))
        rows = tuple(
            (key_of(e.name), f"{e.value:.6g} {e.unit}".strip(), f"{e.deviation:.2g}", e.verdict) for e in self.estimates
        )
        return Table(columns, rows, title=repr(self)[1:-1], note="\n".join(self.unidentifiable))._repr_html_()

    def _placed(self, owner: str) -> pin.SE3:
        T, values = np.eye(4), self.fit.values
        for motion in ("x", "y", "z", "rx", "ry", "rz"):
            T = T @ small_motion(motion, values[owner, motion])
        return pin.SE3(T)

    def _origins(self) -> dict[str, tuple[Floats, Floats]]:
        """New placements of moved joints in their parent links: xyz [m], roll pitch yaw [rad]."""
        values, found = self.fit.values, {}
        for joint, align in zip(self.model.joints, self.model.aligned, strict=True):
            own = {motion: values[joint.name, motion] for motion in (*placed_by(joint), "zero")}
            if max(map(abs, own.values())) == 0.0:
                continue
            E, sense = np.eye(4), -1.0 if joint.upward else 1.0
            for motion in placed_by(joint):
                E = E @ small_motion(motion, own[motion])
            E = E @ small_motion("z" if joint.slides else "rz", sense * own["zero"])
            A = np.eye(4)
            A[:3, :3] = align
            T = _placement(self.nominal.robot, joint.name) @ A @ E @ A.T
            found[joint.name] = (T[:3, 3], rpy(pin.SE3(np.ascontiguousarray(T[:3, :3]), T[:3, 3])))
        return found


def calibrate(
    chain: UrdfChain,
    measurements: Measurements,
    parameters: str | Sequence[str] = "offsets",
    *,
    priors: Mapping[NumberName, float] | None = None,
    robust: bool = True,
) -> Calibration:
    """The numbers of a chain that its measurements say, by weighted least squares with analytic derivatives.

    What the measurements cannot tell stays at its nominal value and is named in ``unidentifiable``.

    Args:
        chain: A chain of a robot.
        measurements: See `nao_kin.calibration.measurements.Measurements`.
        parameters: ``"offsets"``, ``"ratios"``, ``"geometry"``, several joined by ``+``, or names, see
            `nao_kin.calibration.parameters.chosen`.
        priors: How far the maker's figures may be off: standard deviations by name [m or rad].
        robust: Whether rows far off pull with a bounded force.

    Returns:
        The calibration.

    Raises:
        InvalidInputError: Not a chain of a robot, no rows, joints of another number than the chain's, or fewer numbers
            measured than are asked for.
        UnknownNameError: No such number; carries near matches.
    """
    if not isinstance(chain, UrdfChain) or not chain.is_bare:
        raise InvalidInputError("chain", "a chain of a robot between two of its frames", f"{chain!r}"[:60])
    if not len(measurements):
        raise InvalidInputError("measurements", "at least one row", "none")
    for block in measurements.blocks:
        if block.Q.shape[1] != len(chain.joints):
            expected = f"{len(chain.joints)} joints a row ({', '.join(chain.joint_names)})"
            raise InvalidInputError(f"{block.kind}", expected, f"{block.Q.shape[1]}")
    model = model_of(chain)
    system = system_of({None: model}, measurements.blocks, chosen(parameters, [model]), priors)
    measured = sum(block.rows * len(block.noise) for block in measurements.blocks)
    if measured < len(system.names):
        raise InvalidInputError("measurements", f"at least {len(system.names)} numbers", f"{measured}")
    fit = solved(system, robust=robust)
    noise = float(np.sqrt(np.sum(fit.residuals**2) / max(fit.freedom, 1)))
    return Calibration(chain, model, measurements, fit, noise)


def _sparse(directions: Floats) -> Floats:
    """A basis (k, u) of the space of columns (u, k), each vector with as few entries as elimination leaves."""
    R = directions.T.copy()
    row = 0
    for column in range(R.shape[1]):
        if row == len(R):
            break
        pivot = row + int(np.abs(R[row:, column]).argmax())
        if abs(R[pivot, column]) <= _PART * np.abs(R).max():
            continue
        R[[row, pivot]] = R[[pivot, row]]
        R[row] /= R[row, column]
        for other in range(len(R)):
            if other != row:
                R[other] -= R[other, column] * R[row]
        row += 1
    return R[:row]


def _placement(robot: Robot, joint: str) -> Floats:
    origin = robot.document.joint(joint).origin
    return np.asarray(from_xyz_rpy(origin.xyz, origin.rpy).homogeneous)


def _sentence(text: str) -> str:
    return text[0].upper() + text[1:]


def _amount(e: Estimate) -> str:
    if e.unit == "m":
        return f"{1e3 * e.value:.4g} mm (± {1e3 * e.deviation:.2g})"
    if e.unit == "rad":
        return f"{1e3 * e.value:.4g} mrad (± {1e3 * e.deviation:.2g})"
    return f"{e.value:.6g} (± {e.deviation:.2g})"
