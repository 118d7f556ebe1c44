"""Many trials, and what they add up to."""
