"""The closed form of the NAO's head derived with SymPy: chain, equations, solution, and a numeric function made of it.

It goes the way of the MATLAB example: the camera's height gives the pitch, its x then gives yaw and y together. The
package itself solves with `nao_kin.analytic.nao.nao_head`, which this derivation checks. SymPy comes with the extra
``symbolic`` and is imported when it is needed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final

from nao_kin.errors import MissingExtraError

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["HeadDerivation", "derive_head"]

_REAL: Final = 1e-9  # imaginary parts and denominators below this are rounding


@dataclass(frozen=True, eq=False, slots=True)
class HeadDerivation:
    """What SymPy finds, step by step; all angles in radians, all lengths in one unit.

    Attributes:
        symbols: The symbols by name: ``yaw``, ``pitch``, ``x``, ``y``, ``z`` (the camera's place), ``camera_x``,
            ``camera_z``, ``neck_offset_z``, and ``ahead``, how far the pitched camera is before the neck.
        equations: The three expressions that are 0, the example's eq1 to eq3.
        half_pitches: Tangent of half the pitch, two expressions, from eq3.
        ahead: How far the camera is before the neck, in terms of the pitch, from eq1.
        half_yaws: Pairs of the tangent of half the yaw and y, in terms of x and ``ahead``, from eq1 and eq2.
    """

    symbols: dict[str, Any]
    equations: tuple[Any, ...]
    half_pitches: tuple[Any, ...]
    ahead: Any
    half_yaws: tuple[tuple[Any, Any], ...]

    def function(self) -> Callable[[float, float, float, float, float], list[tuple[float, float, float]]]:
        """A numeric function of x, z, camera_x, camera_z and neck_offset_z.

        It returns triples (yaw, pitch, y) of every real solution, angles in (−π, π].
        """
        sympy, s = _sympy(), self.symbols
        lengths = (s["camera_x"], s["camera_z"], s["neck_offset_z"])
        pitches = [sympy.lambdify((s["z"], *lengths), e, "cmath") for e in self.half_pitches]
        ahead_of = sympy.lambdify((s["pitch"], *lengths), self.ahead, "math")
        pairs = [sympy.lambdify((s["x"], s["ahead"]), pair, "cmath") for pair in self.half_yaws]

        def solve(
            x: float, z: float, camera_x: float, camera_z: float, neck_offset_z: float
        ) -> list[tuple[float, float, float]]:
            found = []
            for half_pitch in pitches:
                half = complex(half_pitch(z, camera_x, camera_z, neck_offset_z))
                if abs(half.imag) > _REAL:
                    continue
                pitch = 2.0 * math.atan(half.real)
                ahead = ahead_of(pitch, camera_x, camera_z, neck_offset_z)
                for pair in pairs:
                    half, y = (complex(value) for value in pair(x, ahead))
                    if max(abs(half.imag), abs(y.imag)) <= _REAL:
                        found.append((2.0 * math.atan(half.real), pitch, y.real))
            return found

        return solve


def derive_head() -> HeadDerivation:
    """Derives the closed form from the chain of matrices.

    Raises:
        MissingExtraError: SymPy is not installed.
    """
    sympy = _sympy()
    names = ("yaw", "pitch", "x", "y", "z", "camera_x", "camera_z", "neck_offset_z", "ahead")
    symbols = {name: sympy.Symbol(name, real=True) for name in names}
    yaw, pitch, x, y, z, camera_x, camera_z, neck, ahead = symbols.values()
    quarter, half = sympy.pi / 2, sympy.Symbol("half")
    T_torso_neck = _translation(0, 0, neck)
    T_neck_yaw = _modified_dh(0, 0, 0, yaw)
    T_yaw_pitch = _modified_dh(0, -quarter, 0, pitch - quarter)
    T_pitch_camera = _rotation("x", quarter) * _rotation("y", quarter) * _translation(camera_x, 0, camera_z)
    left = T_neck_yaw.inv() * T_torso_neck.inv() * sympy.Matrix([x, y, z, 1])
    right = (T_yaw_pitch * T_pitch_camera)[:, 3]
    equations = tuple(sympy.simplify(e) for e in (left - right)[:3, 0])
    before_neck = sympy.simplify(right[0])
    level = (equations[0] + before_neck - ahead, equations[1])
    pairs = sympy.solve([_half_angle(equation, yaw, half) for equation in level], [half, y])
    return HeadDerivation(
        symbols=symbols,
        equations=equations,
        half_pitches=tuple(sympy.solve(_half_angle(equations[2], pitch, half), half)),
        ahead=before_neck,
        # Tangents ±i, which no angle has, come in with the half angle.
        half_yaws=tuple(pair for pair in pairs if sympy.simplify(pair[0] ** 2 + 1) != 0),
    )


def _half_angle(expression: Any, angle: Any, half: Any) -> Any:
    """The polynomial that is 0 where the expression is, with the tangent of half an angle for the angle."""
    sympy, one = _sympy(), 1 + half**2
    rational = expression.subs({sympy.sin(angle): 2 * half / one, sympy.cos(angle): (1 - half**2) / one})
    return sympy.numer(sympy.together(rational))


def _modified_dh(a: Any, alpha: Any, d: Any, theta: Any) -> Any:
    """The example's getT: Rx(α) Tx(a) Rz(θ) Tz(d)."""
    return _rotation("x", alpha) * _translation(a, 0, 0) * _rotation("z", theta) * _translation(0, 0, d)


def _translation(x: Any, y: Any, z: Any) -> Any:
    return _sympy().Matrix([[1, 0, 0, x], [0, 1, 0, y], [0, 0, 1, z], [0, 0, 0, 1]])


def _rotation(axis: str, angle: Any) -> Any:
    """A homogeneous rotation about x, y or z with the usual signs."""
    sympy = _sympy()
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    matrix = sympy.eye(4)
    matrix[i, i] = matrix[j, j] = sympy.cos(angle)
    matrix[j, i], matrix[i, j] = sympy.sin(angle), -sympy.sin(angle)
    return matrix


def _sympy() -> Any:
    try:
        import sympy
    except ImportError:
        raise MissingExtraError("Deriving the head's closed form", "symbolic") from None
    return sympy
