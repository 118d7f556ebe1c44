"""What the rows of a grid add up to, and how that is told."""
