"""Safe reading of untrusted URDF files into plain data."""

from nao_kin.urdf.document import UrdfDocument, UrdfWarning, parse_urdf, read_urdf
from nao_kin.urdf.resources import resolve_mesh
from nao_kin.urdf.size_limits import LIMITS, ReadLimits

__all__ = ["LIMITS", "ReadLimits", "UrdfDocument", "UrdfWarning", "parse_urdf", "read_urdf", "resolve_mesh"]
