"""Moving a whole robot: what several chains do together."""
