"""What a run costs: `python -m benchmarks` prints the tables and keeps them in results/."""
