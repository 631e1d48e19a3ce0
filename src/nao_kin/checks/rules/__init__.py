"""The rules, by topic: each a function from the file under examination to its defects, in file order."""
