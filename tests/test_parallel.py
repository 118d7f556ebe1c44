"""Work spread over processes: every job is done once, and what goes wrong is said."""

import operator
import os
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import pytest

from backend.parallel import spread


@pytest.mark.parametrize("workers", [1, 2])
def test_every_job_is_done_once(workers: int):
    assert sorted(spread(operator.neg, range(20), workers)) == list(range(-19, 1))


@pytest.mark.parametrize("workers", [1, 2])
def test_what_a_job_raises_is_raised_here(workers: int):
    with pytest.raises(ZeroDivisionError):
        list(spread(partial(operator.floordiv, 1), [4, 0, 9], workers))


KILLED = """
import os, pathlib, signal, sys, time
from backend.parallel import spread

def work(folder):
    (pathlib.Path(folder) / str(os.getpid())).touch()
    while len(os.listdir(folder)) < 2:
        time.sleep(0.01)
    if os.path.basename(sorted(os.listdir(folder))[0]) == str(os.getpid()):
        os.kill(os.getppid(), signal.SIGKILL)
    time.sleep(600)

if __name__ == "__main__":
    list(spread(work, sys.argv[1:] * 2, 2))
"""


def test_no_worker_outlives_a_killed_parent(tmp_path: Path):
    script, folder = tmp_path / "killed.py", tmp_path / "workers"
    script.write_text(KILLED)
    folder.mkdir()
    here = os.environ | {"PYTHONPATH": os.getcwd()}
    subprocess.run([sys.executable, script, folder], env=here, timeout=60, check=False)
    workers = [int(path.name) for path in folder.iterdir()]
    deadline_s = time.monotonic() + 10.0
    while any(map(runs, workers)) and time.monotonic() < deadline_s:
        time.sleep(0.05)
    assert len(workers) == 2
    assert not [pid for pid in workers if runs(pid)]


def runs(pid: int) -> bool:
    """Whether a process is there and has not ended yet, whoever is to take notice of that."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False
