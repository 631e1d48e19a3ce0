"""What measurements say the robot is: which of its numbers they move, by how much, and what they cannot tell."""
