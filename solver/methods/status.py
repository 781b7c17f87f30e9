"""How the solution of one step ended."""

CONVERGED, STALLED, SINGULAR, LOST_DIGITS = 0, 1, 2, 3
