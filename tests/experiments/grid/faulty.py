"""Work that goes wrong in every way a worker can, by the index of the trial. For spawned processes."""

import os
import signal
import time
from pathlib import Path

from backend.experiments.grid.cells import Job
from backend.experiments.grid.row import GridRow
from tests.experiments.grid.making import row_of

CRASHES, HANGS, RAISES, ONLY_ONCE = 1, 2, 3, 4
ONCE_FILE = "GRID_TEST_ONCE"


def work(job: Job, settings: str) -> GridRow:
    """As indices say; ``ONLY_ONCE`` crashes the first time it is tried, anywhere."""
    match job.key.index:
        case 1:
            os.kill(os.getpid(), signal.SIGSEGV)
        case 2:
            time.sleep(600.0)
        case 3:
            raise ArithmeticError("a knot in the arm")
        case 4:
            once = Path(os.environ[ONCE_FILE] + job.key.method)
            if not once.exists():
                once.touch()
                os.kill(os.getpid(), signal.SIGKILL)
        case _:
            pass
    return row_of(job, settings)


def slow(job: Job, settings: str) -> GridRow:
    """A trial of a fifth of a second."""
    time.sleep(0.2)
    return row_of(job, settings)
