"""The program that lets Pinocchio read one MJCF file: ``python mjcf_process.py FILE`` prints the model as JSON."""

from __future__ import annotations

import json
import math
import os
import sys
from typing import Any

_MEMORY = 4 << 30  # [bytes]
_SIZES: dict[str, Any] = {
    "Box": lambda shape: (2.0 * shape.halfSide).tolist(),
    "Sphere": lambda shape: [shape.radius],
    "Capsule": lambda shape: [shape.radius, 2.0 * shape.halfLength],
    "Cylinder": lambda shape: [shape.radius, 2.0 * shape.halfLength],
}


def _placement(T: Any) -> list[float]:
    """Translation and quaternion x, y, z, w."""
    import pinocchio as pin

    return [*T.translation.tolist(), *pin.Quaternion(T.rotation).coeffs().tolist()]


def _kind(joint: Any) -> str:
    name = joint.shortname()
    if name == "JointModelFreeFlyer":
        return "free"
    if name.startswith(("JointModelR", "JointModelP")) and not name.startswith("JointModelPlanar"):
        return str(name[len("JointModel")])
    return str(name.removeprefix("JointModel").lower())


def _axis(joint: Any) -> list[float]:
    import pinocchio as pin

    motion = joint.createData() if hasattr(joint, "createData") else None
    if motion is None:
        return [1.0, 0.0, 0.0]
    q = pin.neutral(_single(joint))
    joint.calc(motion, q)
    columns = motion.S.reshape(6, -1)[:, 0]
    vector = columns[3:] if _kind(joint) == "R" else columns[:3]
    return [float(part) for part in vector]


def _single(joint: Any) -> Any:
    import pinocchio as pin

    model = pin.Model()
    model.addJoint(0, joint, pin.SE3.Identity(), "joint")
    return model


def _step(joint: Any, T: Any, lower: float, upper: float) -> dict[str, Any]:
    kind = _kind(joint)
    unbounded = not (math.isfinite(lower) and math.isfinite(upper)) or joint.nq == 2
    return {
        "kind": kind,
        "placement": _placement(T),
        "axis": _axis(joint) if kind in {"R", "P"} else [1.0, 0.0, 0.0],
        "lower": None if unbounded else lower,
        "upper": None if unbounded else upper,
    }


def _joint(model: Any, number: int) -> dict[str, Any]:
    joint, T = model.joints[number], model.jointPlacements[number]
    lower, upper = model.lowerPositionLimit.tolist(), model.upperPositionLimit.tolist()
    parts = [joint]
    places = [T]
    if joint.shortname() == "JointModelComposite":
        composite = joint.extract() if hasattr(joint, "extract") else joint
        parts = list(composite.joints)
        places = [T * composite.jointPlacements[0], *list(composite.jointPlacements)[1:]]
    steps, at = [], joint.idx_q
    for part, place in zip(parts, places, strict=True):
        steps.append(_step(part, place, lower[at], upper[at]))
        at += part.nq
    return {"name": model.names[number], "parent": int(model.parents[number]), "steps": steps}


def _inertia(inertia: Any) -> dict[str, Any]:
    about = inertia.inertia
    six = [about[i, j] for i, j in ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))]
    return {"mass": inertia.mass, "lever": inertia.lever.tolist(), "about_centre": [float(x) for x in six]}


def main() -> None:
    """Reads, prints, leaves without clean-up."""
    import resource

    resource.setrlimit(resource.RLIMIT_AS, (_MEMORY, _MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    answer, sys.stdout = os.fdopen(os.dup(1), "w", encoding="utf-8"), sys.stderr
    os.dup2(2, 1)
    import pinocchio as pin

    try:
        model = pin.buildModelFromMJCF(sys.argv[1])
        geometry = pin.buildGeomFromMJCF(model, sys.argv[1], pin.GeometryType.VISUAL)
    except Exception as error:
        json.dump({"refused": " ".join(str(error).split())[:200].rstrip(".")}, answer)
    else:
        shapes: dict[int, list[dict[str, Any]]] = {}
        for each in geometry.geometryObjects:
            kind = type(each.geometry).__name__
            if kind in _SIZES:
                size = [float(x) for x in _SIZES[kind](each.geometry)]
                colour = [min(max(float(x), 0.0), 1.0) for x in each.meshColor]
                place = {"kind": kind, "size": size, "placement": _placement(each.placement), "colour": colour}
                shapes.setdefault(each.parentJoint, []).append(place)
        bodies = [
            {"name": frame.name, "joint": int(frame.parentJoint), "placement": _placement(frame.placement)}
            for frame in model.frames
            if frame.type == pin.FrameType.BODY
        ]
        joints = [_joint(model, number) for number in range(1, model.njoints)]
        inertias = [_inertia(inertia) for inertia in model.inertias]
        json.dump({"joints": joints, "bodies": bodies, "inertias": inertias, "shapes": shapes}, answer)
    answer.flush()
    os._exit(0)


if __name__ == "__main__":
    main()
