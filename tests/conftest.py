"""One setting for all property tests: the same examples everywhere, and no wall clock in the verdict."""

from hypothesis import settings

settings.register_profile("project", deadline=None, derandomize=True)
settings.load_profile("project")
