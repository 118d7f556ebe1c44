"""The grid: robots x tasks x objects x methods x trials, paired, kept row by row."""
