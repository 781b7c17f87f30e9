"""What the dashboard takes in a real browser, and its pictures."""
