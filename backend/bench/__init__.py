"""bench: what the machinery of motion does and how fast, measured beside what is wanted of it."""
