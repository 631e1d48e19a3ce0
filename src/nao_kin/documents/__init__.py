"""The four source documents as printed, the ledger that runs and judges them, and their chains by name."""
