"""Several tips of a tree of chains, wanted somewhere at once."""
