"""Where the tip of a chain can be, and how well it moves there: maps of cubes, their file and their picture."""
