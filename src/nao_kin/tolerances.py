"""Every threshold that decides a verdict, in one frozen object with the reason for each."""

from __future__ import annotations

from dataclasses import dataclass, fields

from nao_kin.errors import InvalidInputError

__all__ = ["TOLERANCES", "Tolerances"]


@dataclass(frozen=True, slots=True)
class Tolerances:
    """Thresholds of the package's verdicts.

    Attributes:
        position: A tip this near to its target has reached it [m]; far below what any servo resolves.
        rotation: The same for the angle to the wanted orientation [rad].
        limits: How far outside its range a joint may be and still count as inside [rad or m]: the rounding of a closed
            form, not a licence.
        agreement_position: Two chains whose tips stay this near are the same [m]; rounding alone stays a million times
            below it.
        agreement_rotation: The same for the angle between the two tips [rad].

    Raises:
        InvalidInputError: A threshold is negative or not finite.
    """

    position: float = 1e-6
    rotation: float = 1e-6
    limits: float = 1e-9
    agreement_position: float = 1e-9
    agreement_rotation: float = 1e-9

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if not isinstance(value, (int, float)) or not 0.0 <= value < float("inf"):
                raise InvalidInputError(f"tolerance {field.name}", "a finite number ≥ 0", repr(value))


TOLERANCES = Tolerances()
