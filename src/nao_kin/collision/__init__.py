"""Which bodies of a robot touch, and how far apart they are."""

from __future__ import annotations

from nao_kin.collision.model import DISTANCE_ACCURACY, CollisionModel, Excluded, Proximity
from nao_kin.collision.shapes import Plane

__all__ = ["DISTANCE_ACCURACY", "CollisionModel", "Excluded", "Plane", "Proximity"]
