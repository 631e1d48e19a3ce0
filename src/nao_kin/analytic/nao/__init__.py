"""NAO's head, arms and legs in closed form."""
