"""Robots of the package robot_descriptions.py by name, from its cache.

Its modules clone a repository when they are imported. Here they are imported with that step replaced by a look into
the cache, so that loading a robot never downloads; `fetch` does, and only `nao-kin robots --fetch` calls it.
"""

from __future__ import annotations

import importlib
import importlib.util
import os
import threading
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from nao_kin.errors import MissingExtraError, NaoKinError, UnknownNameError

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ["CHAINS", "Description", "NotFetchedError", "description_names", "fetch", "find_description"]

Frames = tuple[str, str]


def _legs(base: str, *feet: str) -> dict[str, Frames]:
    return {f"leg_{foot.partition('_')[0].lower()}": (base, foot) for foot in feet}


_UR: Final[dict[str, Frames]] = {"arm": ("base_link", "tool0")}
CHAINS: Final[dict[str, dict[str, Frames]]] = {
    **dict.fromkeys(
        (f"ur{model}_description" for model in ("3e", "5e", "7e", "10e", "12e", "15", "16e", "18", "20", "30")), _UR
    ),
    **dict.fromkeys(("ur3_official_description", "ur5_official_description", "ur10_official_description"), _UR),
    "fr3_description": {"arm": ("fr3_link0", "fr3_hand_tcp")},
    "fer_description": {"arm": ("fer_link0", "fer_hand_tcp")},
    "panda_description": {"arm": ("panda_link0", "panda_hand")},
    "iiwa7_description": {"arm": ("iiwa_link_0", "iiwa_link_ee")},
    "iiwa14_description": {"arm": ("iiwa_link_0", "iiwa_link_ee")},
    "gen3_description": {"arm": ("base_link", "end_effector_link")},
    "xarm6_description": {"arm": ("link_base", "link_eef")},
    "xarm7_description": {"arm": ("link_base", "link_eef")},
    "so_arm101_description": {"arm": ("base_link", "gripper_frame_link")},
    "piper_description": {"arm": ("base_link", "gripper_base")},
    "go2_description": _legs("base", "FL_foot", "FR_foot", "RL_foot", "RR_foot"),
    "go1_description": _legs("base", "FL_foot", "FR_foot", "RL_foot", "RR_foot"),
    "h1_description": {
        "left_leg": ("pelvis", "left_ankle_link"),
        "right_leg": ("pelvis", "right_ankle_link"),
        "left_arm": ("torso_link", "left_elbow_link"),
        "right_arm": ("torso_link", "right_elbow_link"),
    },
}
"""Named chains of the descriptions most used, by the frames that their makers publish.

Any other robot has the chains of an SRDF beside it, and its end links.
"""

_LOCK = threading.Lock()


class NotFetchedError(NaoKinError, FileNotFoundError):
    """A description is not in the cache.

    Attributes:
        name: The description.
    """

    def __init__(self, name: str) -> None:
        self.name = name
        super().__init__(
            f"The description {name!r} is not in the cache of robot_descriptions.py, and nothing is downloaded without "
            f"being asked. Fetch it once, while there is a network: nao-kin robots --fetch {name}"
        )


@dataclass(frozen=True, slots=True)
class Description:
    """A description that is in the cache.

    Attributes:
        name: Its name, as ``ur5e_description``.
        path: The URDF, xacro or MJCF file.
        arguments: What its macros are expanded with.
        packages: Folders that hold packages.
        chains: Its named chains.
    """

    name: str
    path: Path
    arguments: Mapping[str, object] = field(default_factory=dict)
    packages: tuple[Path, ...] = ()
    chains: Mapping[str, Frames] = field(default_factory=dict)


def description_names() -> tuple[str, ...]:
    """Every description that the package knows, fetched or not; none where it is not installed."""
    if importlib.util.find_spec("robot_descriptions") is None:
        return ()
    table = importlib.import_module("robot_descriptions._descriptions").DESCRIPTIONS
    return tuple(name for name, each in table.items() if each.has_urdf or each.has_mjcf)


def full_name(name: str) -> str:
    """The name of a description by its name or its short one.

    Raises:
        UnknownNameError: There is none; carries near matches.
        MissingExtraError: It ends as a description does, and the package is not installed.
    """
    names = description_names()
    if not names and name.endswith("_description"):
        raise MissingExtraError(f"The description {name!r}", "descriptions")
    for candidate in (name, f"{name}_description", f"{name}_mj_description"):
        if candidate in names:
            return candidate
    raise UnknownNameError("robot description", name, names)


def find_description(name: str) -> Description:
    """A description by its name or its short one, from the cache.

    Raises:
        UnknownNameError, MissingExtraError: See `full_name`.
        NotFetchedError: It is not in the cache.
    """
    name = full_name(name)
    with _LOCK:
        cache: Any = importlib.import_module("robot_descriptions._cache")
        original = cache.clone_to_cache
        cache.clone_to_cache = lambda repository, commit=None: _cached(name, repository, commit)
        try:
            module = importlib.import_module(f"robot_descriptions.{name}")
        finally:
            cache.clone_to_cache = original
    return _described(name, module)


def fetch(name: str) -> Description:
    """Download a description, as importing its module does, and find it.

    Raises:
        UnknownNameError, MissingExtraError: See `full_name`.
        NotFetchedError: It could not be downloaded.
    """
    name = full_name(name)
    try:
        module = importlib.import_module(f"robot_descriptions.{name}")
    except Exception as error:  # git, the network, the disk: whatever a download stumbles on
        raise NotFetchedError(name) from error
    return _described(name, module)


def _cached(name: str, repository: str, commit: str | None) -> str:
    repositories = importlib.import_module("robot_descriptions._repositories").REPOSITORIES
    folder = os.path.expanduser(os.environ.get("ROBOT_DESCRIPTIONS_CACHE", "~/.cache/robot_descriptions"))  # noqa: PTH111
    path = repositories[repository].cache_path
    place = Path(folder) / (path if commit is None else f"{path}-{commit}/{path}")
    if not place.is_dir():
        raise NotFetchedError(name)
    return str(place)


def _described(name: str, module: Any) -> Description:
    attributes = vars(module)
    path = next((attributes[key] for key in ("URDF_PATH", "XACRO_PATH", "MJCF_PATH") if key in attributes), None)
    if path is None or not Path(path).is_file():
        raise NotFetchedError(name)
    repository, package = Path(attributes["REPOSITORY_PATH"]), Path(attributes["PACKAGE_PATH"])
    packages = (repository.parent, repository, package, package.parent)
    arguments = attributes.get("XACRO_ARGS", {}) if str(path).endswith(".xacro") else {}
    return Description(name, Path(path), dict(arguments), tuple(dict.fromkeys(packages)), CHAINS.get(name, {}))
