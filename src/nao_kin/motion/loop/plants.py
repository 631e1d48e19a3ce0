"""What a servo drives: motors that follow a speed with a lag, or the rigid bodies of the whole robot.

Both take commanded speeds and keep positions and speeds of all motors; neither models friction, play, flexibility or
the stops at the ends of a range.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Protocol

import numpy as np
import pinocchio as pin

from nao_kin.arrays import Floats, positive, vector
from nao_kin.errors import InvalidInputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from nao_kin.robot.motors import Motors

__all__ = ["Plant", "PlantState", "RigidBodies", "VelocityServos"]

_LEAST_INERTIA: Final = 1e-9  # [kg m² or kg] of a motor that moves nothing


@dataclass(frozen=True, eq=False, slots=True)
class PlantState:
    """Positions, speeds and efforts of all motors, (n,) each.

    Attributes:
        q: Positions [rad or m].
        velocity: Speeds [rad/s or m/s].
        effort: What the motors push with [N m or N]; 0 where the plant has none.
        at_limit: Whether a motor's effort was cut to its limit.
    """

    q: Floats
    velocity: Floats
    effort: Floats
    at_limit: NDArray[np.bool_]


class Plant(Protocol):
    """What takes commanded speeds."""

    @property
    def motors(self) -> Motors:
        """Its motors."""

    def at_rest(self, q: Floats) -> PlantState:
        """The state that stands still at motor values (n,)."""

    def advance(self, state: PlantState, command: Floats, period: float) -> PlantState:
        """The state a period [s] later, with commanded speeds (n,) held during it."""


class VelocityServos:
    """Motors whose speed follows the commanded one with a first-order lag, each for itself: v̇ = (u − v) / τ.

    Args:
        motors: The motors.
        time_constant: τ [s].

    Raises:
        InvalidInputError: A time constant that is not above 0.
    """

    def __init__(self, motors: Motors, time_constant: float = 0.02) -> None:
        self.motors, self.time_constant = motors, positive(time_constant, "time_constant", "[s]")

    def at_rest(self, q: Floats) -> PlantState:
        """See `Plant`."""
        return _still(q)

    def advance(self, state: PlantState, command: Floats, period: float) -> PlantState:
        """See `Plant`; exact, since the command is constant meanwhile."""
        decay = math.exp(-period / self.time_constant)
        behind = state.velocity - command
        q = state.q + command * period + behind * self.time_constant * (1.0 - decay)
        return PlantState(q, command + behind * decay, state.effort, state.at_limit)


class RigidBodies:
    """The whole robot by Pinocchio's forward dynamics, its root fixed to the world, z up.

    Each motor pushes with I (u − v) / τ plus what gravity asks for at the measured posture, cut to its effort limit.
    I is its own entry of the mass matrix at the posture `tuned_at`: a drive is tuned once, for one posture, as a real
    one is. Followers move with their leaders.

    Args:
        motors: The motors.
        tuned_at: Motor values (n,) at which the drives are tuned.
        time_constant: τ [s].
        armature: Inertia of the motors themselves at the joints, one number or (n,) [kg m² or kg]; URDF has none.
        compensate_gravity: Whether the drives know gravity.
        step: Longest step of integration [s], semi-implicit Euler, the drives running at that rate.

    Raises:
        InvalidInputError: A motor that moves no mass, numbers that are not above 0, or a step too long for drives as
            fast as these.
    """

    def __init__(
        self,
        motors: Motors,
        tuned_at: ArrayLike,
        *,
        time_constant: float = 0.005,
        armature: ArrayLike = 0.0,
        compensate_gravity: bool = True,
        step: float = 5e-4,
    ) -> None:
        n = len(motors.joints)
        self.motors, self.compensate_gravity = motors, compensate_gravity
        self.time_constant = positive(time_constant, "time_constant", "[s]")
        self.step = positive(step, "step", "[s]")
        self.armature = vector(np.broadcast_to(np.asarray(armature, dtype=np.float64), n), "armature", n)
        self._columns = motors.pinocchio_columns
        self._model = motors.robot.model.copy()  # the robot's own one stays as it is
        own = [self._columns[motors.robot.joint_names.index(name)] for name in motors.joint_names]
        self._model.armature[own] = self.armature
        self._data = self._model.createData()
        self.max_effort = self._efforts()
        mass = self.mass_matrix(vector(tuned_at, "tuned_at", n))
        self.inertia: Floats = np.diag(mass).copy()
        weightless = np.flatnonzero(self.inertia < _LEAST_INERTIA)
        if len(weightless):
            names = ", ".join(motors.joint_names[int(k)] for k in weightless)
            raise InvalidInputError("masses", f"some that {names} move; else give armature=", "none")
        # Through the other joints a motor feels less than its own inertia, so its drive answers faster than τ.
        fastest = float(np.linalg.eigvals(np.linalg.solve(mass, np.diag(self.inertia))).real.max()) / self.time_constant
        if self.step * fastest > 1.9:
            raise InvalidInputError("step", f"at most {1.9 / fastest:.2g} s for such drives", f"{self.step:g} s")

    def at_rest(self, q: Floats) -> PlantState:
        """See `Plant`."""
        return _still(q)

    def advance(self, state: PlantState, command: Floats, period: float) -> PlantState:
        """See `Plant`."""
        steps = math.ceil(period / self.step - 1e-9)
        h = period / steps
        q, v, cut = state.q.copy(), state.velocity.copy(), np.zeros(len(state.q), dtype=bool)
        for _ in range(steps):
            wanted = self.inertia * (command - v) / self.time_constant
            if self.compensate_gravity:
                wanted += self.bias(q, np.zeros_like(v))
            effort = np.clip(wanted, -self.max_effort, self.max_effort)
            cut |= effort != wanted
            v = v + h * self.acceleration(q, v, effort)
            q = q + h * v
        return PlantState(q, v, effort, cut)

    def acceleration(self, q: Floats, velocity: Floats, effort: Floats) -> Floats:
        """Accelerations (n,) of the motors under efforts (n,): ABA; with couplings, its equation on their span."""
        motors = self.motors
        if motors.robot.couplings:
            push = effort - self.bias(q, velocity)
            return np.asarray(np.linalg.solve(self.mass_matrix(q), push), dtype=np.float64)
        model, columns = self._model, self._columns
        model_v, model_effort = np.zeros(model.nv), np.zeros(model.nv)
        model_v[columns], model_effort[columns] = motors.spread @ velocity, motors.spread @ effort
        found = pin.aba(model, self._data, motors.pinocchio_q(q), model_v, model_effort)
        free: Floats = motors.spread.T @ found[columns]
        return free

    def mass_matrix(self, q: Floats) -> Floats:
        """Inertia (n, n) that the motors feel, armature included [kg m² or kg]."""
        model, columns, spread = self._model, self._columns, self.motors.spread
        full = np.array(pin.crba(model, self._data, self.motors.pinocchio_q(q)))
        full = np.triu(full) + np.triu(full, 1).T  # Pinocchio fills the upper half
        felt: Floats = spread.T @ full[np.ix_(columns, columns)] @ spread
        return felt

    def bias(self, q: Floats, velocity: Floats) -> Floats:
        """Efforts (n,) that hold all speeds constant: gravity, centrifugal and Coriolis [N m or N]."""
        model, columns, spread = self._model, self._columns, self.motors.spread
        model_v = np.zeros(model.nv)
        model_v[columns] = spread @ velocity
        full = pin.rnea(model, self._data, self.motors.pinocchio_q(q), model_v, np.zeros(model.nv))
        felt: Floats = spread.T @ full[columns]
        return felt

    def energy(self, q: Floats, velocity: Floats) -> float:
        """Kinetic and potential energy [J], armature included."""
        model = self._model
        height = pin.computePotentialEnergy(model, self._data, self.motors.pinocchio_q(q))
        return float(0.5 * velocity @ self.mass_matrix(q) @ velocity + height)

    def _efforts(self) -> Floats:
        """Effort limits of the motors; infinite where the file has none."""
        limits = {joint.name: joint.limit for joint in self.motors.robot.moving_joints}
        efforts = [limit.effort if (limit := limits[name]) else None for name in self.motors.joint_names]
        return np.array([math.inf if effort is None else effort for effort in efforts])


def _still(q: Floats) -> PlantState:
    return PlantState(q.copy(), np.zeros_like(q), np.zeros_like(q), np.zeros(len(q), dtype=bool))
