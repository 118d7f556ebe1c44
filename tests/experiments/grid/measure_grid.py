"""Measure real grids: ``python -m tests.experiments.grid.measure_grid [--methods 6] [--kills 20] [--no-ray]``.

The same trials, of both robots, all tasks and all objects, with the paper's thinking time, are run by two workers, by
one, by a grid that is killed again and again, and on two Ray nodes of which one is lost half-way. Prints trials a
second, what a worker takes of memory, and how many rows are missing, double, or other than those of the first run.
"""

from __future__ import annotations

import argparse
import json
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Generator, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from backend.bench.figure import Figure
from backend.errors import GraspingError
from backend.experiments.grid.folder import read_grid
from backend.experiments.grid.row import GridRow
from tests.experiments.grid.test_driver import group_lives

METHODS = ("ours_rm", "baseline", "reachability", "motion_aware", "no_seeding", "no_prediction")
CELLS = 2 * 7 * 7
PER_CORE_HZ = 2.0
TWO_AGAINST_ONE = 1.8
WORKER_MB = 450.0
WARM_UP_ROWS = 20
"""Not counted in a rate: the first trials load what is kept for the others."""
KILLED_AFTER_S = (1.0, 10.0)
LOOK_S = 0.5


@dataclass(frozen=True)
class Course:
    """How a run went."""

    rows: list[GridRow]
    trials_hz: float
    worker_MB: float
    """Most of any worker."""


class Grid:
    """The same trials again and again, each time in another folder."""

    def __init__(self, root: Path, methods: int) -> None:
        self._root = root
        self._methods = METHODS[:methods]
        self.trials = CELLS * methods

    def folder(self, name: str) -> Path:
        return self._root / name

    def words(self, name: str, *more: str) -> list[str]:
        asked = ["--out", str(self.folder(name)), "--trials", "1", "--think", "paper", "--methods", *self._methods]
        return [sys.executable, "-m", "backend", "grid", *asked, *more]

    @contextmanager
    def begun(self, name: str, *more: str) -> Generator[subprocess.Popen[bytes]]:
        """In a process group of its own, nothing of which is left afterwards."""
        with subprocess.Popen(self.words(name, *more), stderr=subprocess.DEVNULL, start_new_session=True) as process:
            try:
                yield process
            finally:
                if process.poll() is None:
                    process.kill()
        while group_lives(process.pid):
            time.sleep(LOOK_S)

    def course(self, name: str, *more: str) -> Course:
        """Run to its end, looked at from time to time."""
        seen: list[tuple[float, int]] = []
        most_MB = 0.0
        with self.begun(name, *more) as process:
            while process.poll() is None:
                time.sleep(LOOK_S)
                seen.append((time.monotonic(), len(self.rows(name))))
                most_MB = max([most_MB, *children_MB(process.pid)])
            assert process.returncode == 0, f"the grid `{name}` ended with {process.returncode}"
        (begin_s, first), (end_s, last) = next(s for s in seen if s[1] >= WARM_UP_ROWS), seen[-1]
        return Course(self.rows(name), (last - first) / (end_s - begin_s), most_MB)

    def rows(self, name: str) -> list[GridRow]:
        """Those that are there; none while there is no store yet."""
        try:
            with read_grid(self.folder(name)) as store:
                return list(store.rows())
        except GraspingError:
            return []


def children_MB(pid: int) -> Iterator[float]:
    """Resident memory of a process's children, whichever of its threads began them."""
    for of_a_thread in Path(f"/proc/{pid}/task").glob("*/children"):
        try:
            for child in of_a_thread.read_text().split():
                yield int(Path(f"/proc/{child}/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") / 1e6
        except (FileNotFoundError, ProcessLookupError):
            continue


def differences(part: str, rows: list[GridRow], wanted: list[GridRow]) -> Iterator[Figure]:
    """Of rows against those of another run of the same trials."""
    times = Counter(row.key for row in rows)
    of = {row.key: row.sure() for row in wanted}
    count = len(wanted)
    yield Figure(part, "rows missing", sum(1 for key in of if key not in times), target=0, of=count)
    yield Figure(part, "rows double", sum(number - 1 for number in times.values()), target=0, of=count)
    yield Figure(
        part, "rows other than the first run's", sum(r.sure() != of.get(r.key) for r in rows), target=0, of=count
    )


def kill(grid: Grid, name: str, times: int, seed: int) -> tuple[int, int]:
    """Begin a grid and kill it at a random moment, so often; then let it end.

    How often it had not ended before that moment, and how many rows the last kill left.
    """
    chance = np.random.default_rng(seed)
    killed = left = 0
    for _ in range(times):
        with grid.begun(name) as process:
            try:
                process.wait(float(chance.uniform(*KILLED_AFTER_S)))
            except subprocess.TimeoutExpired:
                os.kill(process.pid, signal.SIGKILL)
                killed += 1
        left = len(grid.rows(name))
    with grid.begun(name) as process:
        assert process.wait() == 0
    return killed, left


def lose_a_node(grid: Grid, name: str) -> int:
    """Run on two Ray nodes and take one away half-way; how many rows there were then."""
    from ray.cluster_utils import Cluster  # pyright: ignore[reportMissingImports]

    cluster: Any = Cluster(initialize_head=True, head_node_args={"num_cpus": 1, "include_dashboard": False})
    node = cluster.add_node(num_cpus=1)
    try:
        with grid.begun(name, "--executor", "ray", "--ray-address", cluster.address) as process:
            while (there := len(grid.rows(name))) < grid.trials // 2 and process.poll() is None:
                time.sleep(LOOK_S)
            cluster.remove_node(node, allow_graceful=False)
            assert process.wait() == 0
    finally:
        cluster.shutdown()
    return there


def measure(grid: Grid, kills: int, with_ray: bool) -> Iterator[Figure]:
    """Every figure as it is found."""
    two = grid.course("two", "--workers", "2")
    yield Figure("throughput", "two workers", two.trials_hz, "per s", of=grid.trials)
    one = grid.course("one", "--workers", "1")
    yield Figure("throughput", "one worker", one.trials_hz, "per s", ">=", PER_CORE_HZ, grid.trials)
    yield Figure("throughput", "two against one", two.trials_hz / one.trials_hz, "x", ">=", TWO_AGAINST_ONE)
    yield Figure("throughput", "most memory of a worker", max(one.worker_MB, two.worker_MB), "MB", "<=", WORKER_MB)
    yield from differences("one worker", one.rows, two.rows)
    killed, left = kill(grid, "killed", kills, seed=0)
    yield Figure("killed", "times, before it had ended", killed, of=kills)
    yield Figure("killed", "rows there after the last", left, of=grid.trials)
    yield from differences("killed", grid.rows("killed"), two.rows)
    if with_ray:
        yield Figure("two Ray nodes", "rows there when a node was lost", lose_a_node(grid, "ray"), of=grid.trials)
        yield from differences("two Ray nodes", grid.rows("ray"), two.rows)


def main() -> int:
    """Exit code 1 when a figure misses its target."""
    parser = argparse.ArgumentParser(prog="python -m tests.experiments.grid.measure_grid", description=__doc__)
    parser.add_argument("--methods", type=int, default=len(METHODS), choices=range(1, 7), help="98 trials each")
    parser.add_argument("--kills", type=int, default=20)
    parser.add_argument("--no-ray", action="store_true")
    parser.add_argument("--json", action="store_true", help="one JSON object per line")
    options = parser.parse_args()
    missed = False
    with tempfile.TemporaryDirectory(prefix="grid-") as root:
        for figure in measure(Grid(Path(root), options.methods), options.kills, not options.no_ray):
            missed |= figure.met is False
            print(json.dumps(figure.as_dict()) if options.json else f"{figure.part:14}{figure.line()}", flush=True)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
