"""Executors: where the trials of a grid are run. All have the verbs of ``Executor``."""
