"""Grasping moving objects: the headless engine."""

import os

__version__ = "0.1.0"

# One thread for numpy's products: they are small, a second thread waits longer than it works when the other
# cores are busy, and the last bit of a result must not depend on how many cores there are.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
