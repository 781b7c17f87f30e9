"""Writes the parts of the client that follow from others: the types of cases, and the client without await."""
