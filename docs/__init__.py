"""What writes the tables of the documents: `python -m docs`."""
