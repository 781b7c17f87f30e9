"""Published scenes, and what a correct solver must show on them. `python -m validation [name ...]` prints the table."""
