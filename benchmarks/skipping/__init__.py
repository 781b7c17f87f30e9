"""What a feature costs a scene that does not need it: `python -m benchmarks.skipping`."""
