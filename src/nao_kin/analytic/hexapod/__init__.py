"""Legs of three joints, and the body that stands on several of them."""
