"""A NAO in motion: feet, torso, gaze, keyframes."""
