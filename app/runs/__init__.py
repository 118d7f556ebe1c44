"""Grids on the page: the folder they lie in, what is known of each, and the one that the page runs."""
