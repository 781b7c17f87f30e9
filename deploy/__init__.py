"""What runs hockle elsewhere, and a rehearsal of it."""
