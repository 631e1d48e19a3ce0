"""Closed-form inverse kinematics: every solution of a known geometry, found in a chain by measuring, never by names."""
