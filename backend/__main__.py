"""The headless command line: trial, grid, merge, export, trials, survey, replay, render, build, ..."""

import gc
import sys

from backend.cli import main

OBJECTS_BETWEEN_SWEEPS = 100_000
"""Importing and loading kernels makes many objects that stay; Python's 700 would sweep them again and again."""

if __name__ == "__main__":
    gc.set_threshold(OBJECTS_BETWEEN_SWEEPS, 50, 50)
    sys.exit(main())
