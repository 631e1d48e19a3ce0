"""nao_kin."""
