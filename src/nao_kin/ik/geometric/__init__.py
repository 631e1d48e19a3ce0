"""Methods that look at points and axes instead of a Jacobian: CCD, FABRIK, follow the leader."""
