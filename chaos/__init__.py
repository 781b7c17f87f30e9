"""Faults on purpose: real processes, brokers and databases, and what became of every job."""
