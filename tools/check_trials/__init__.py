"""What the trials of `nao-kin check` are made of: mutants of files, and single defects put into them."""
