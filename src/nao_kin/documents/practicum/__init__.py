"""The practicum sheet on numeric inverse kinematics of a 6-axis arm: a module a section."""
