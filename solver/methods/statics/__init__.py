"""Statics: equilibria of the staggered method's chain, followed as loads and ends change. See `run.Equilibria`."""
