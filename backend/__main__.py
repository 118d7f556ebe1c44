"""The headless command line: trial, survey, replay, build, object, bench, warm, info."""

import sys

from backend.cli import main

if __name__ == "__main__":
    sys.exit(main())
