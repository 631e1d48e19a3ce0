"""A hexapod in motion: footfall, gait, commands to walk."""
