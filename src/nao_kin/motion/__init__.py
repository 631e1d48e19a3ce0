"""Moving a whole robot: several chains together, servos, a guard against collisions, and a loop in real time."""
