"""CPU time against error, hockle's methods beside its peers: `python -m benchmarks.work_precision`."""
