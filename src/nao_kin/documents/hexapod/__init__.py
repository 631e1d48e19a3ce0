"""The hexapod article (M. Fauth, "Inverse Kinematik", 2010)."""
