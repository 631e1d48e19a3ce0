"""What the head of each NAO file says: the robot, its sources, and the decisions taken."""

from __future__ import annotations

_TITLES = {
    "v32": "Aldebaran NAO V3.2",
    "v33": "Aldebaran NAO V3.3",
    "v40": "Aldebaran NAO V4 (NAO Next Gen)",
    "v50": "Aldebaran / SoftBank Robotics NAO V5 (NAO Evolution)",
    "v60": "SoftBank Robotics NAO V6 (NAO Power V6)",
}
_BODIES = {
    True: "H25 body: with wrist and hand motors.",
    False: "H21 body: without wrist and hand motors. The figures of wrist and hand are merged into the forearm by the "
    "parallel-axis theorem; l_wrist, r_wrist, l_gripper and r_gripper remain as fixed frames. So it weighs as much as "
    "H25; the NAOqi documentation gives H21 V3.3 0.117 kg less.",
}
_SOURCES = (
    "Sources: lengths, effectors, cameras and motors from the NAOqi documentation; joint and frame names, axes, "
    "limits, efforts, sensor frames, masses and inertias from the generated nao.urdf files of ros-naoqi/nao_robot; "
    "speeds of V4 to V6 from the rUNSWift release. The shapes are drawn by us from primitives; no vendor mesh is used."
)
_FRAMES = (
    "Frames: at zero all joint frames are parallel to the torso's, x forward, y left, z up. The soles l_sole and "
    "r_sole are 45.11 mm below the ankle as in the public URDF of every version. {effector} LArm and RArm are the "
    "documented hand effectors, fixed to the last link before the hand opens. The effector Head is the Head link "
    "itself."
)
_EFFECTORS = {
    True: "LLeg and RLeg are the documented foot effectors, 45.11 mm below the ankle in V3.2.",
    False: "LLeg and RLeg are the documented foot effectors, 45.19 mm below the ankle from V3.3 on.",
}
_DECISIONS = (
    "Decisions: the HipYawPitch axes are exactly (0, 1, -1)/sqrt(2) and (0, 1, 1)/sqrt(2) where the public URDF prints "
    "0.707106. One motor turns both hips, so RHipYawPitch mimics LHipYawPitch. HandOffsetZ is 12.31 mm on both sides "
    "(15.9 mm in V3.2); one public file prints 0.01213 on the right. Speeds are the no-load figures of this version's "
    "motors. Limits and efforts are printed as in the public URDF, asymmetries between left and right included."
)
_MASSES = {
    "v32": "Masses: those of V3.3, none are published for V3.2. The V3.3 hip inertia is non-physical as published (izz "
    "larger than ixx + iyy); V4's is taken instead.",
    "v33": "Masses: V3.3. Its hip inertia is non-physical as published (izz larger than ixx + iyy); V4's is taken "
    "instead.",
    "v40": "Masses: V4.",
    "v50": "Masses: V5.",
    "v60": "Masses: those of V5, as rUNSWift uses them (B-Human's heavier head of 0.659 kg is not taken); no public "
    "URDF of V6 is known to us, so its soles, limits, efforts and sensor frames are V5's too.",
}


def paragraphs(version: str, *, full: bool) -> tuple[str, ...]:
    """The paragraphs of one file's header comment."""
    frames = _FRAMES.format(effector=_EFFECTORS[version == "v32"])
    return (f"{_TITLES[version]}, {_BODIES[full]}", _SOURCES, frames, _DECISIONS, _MASSES[version])
