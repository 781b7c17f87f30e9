"""How the service bears many clients: `python -m benchmarks.load`."""
