"""A robot in a loop in real time: servos, the guard against collisions, streams of messages."""
