"""Grasping moving objects: the headless engine."""

__version__ = "0.1.0"
