"""The solver pushed to its limits: sweeps, maps and random cases, each run judged by its own books."""
