"""What is solved: one file a scene, each with `runs()`."""
