"""Inverse kinematics: problems, methods, and results that were measured again."""
