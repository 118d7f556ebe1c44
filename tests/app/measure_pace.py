"""Measure what a viewer costs the simulation: ``python -m tests.app.measure_pace [--times 5] [--json]``.

The same trial as fast as it goes, in turn without a viewer and with one that takes in all that it is sent and draws
nothing: a visitor has a machine of his own to draw on, while a browser here would take the cores of the simulation.
"""

from __future__ import annotations

import argparse
import json
import statistics
import sys
import threading
import time
from collections.abc import Generator
from contextlib import ExitStack, contextmanager

from tests.app.measure_page import cpu_s
from tests.app.served import Served, begin_anew, serve, wait_for
from tests.app.viewer_client import view

MOST_LOST = 0.05
LOOK_S = 0.1


def trial(served: Served, *, watched: bool) -> tuple[float, float]:
    """Simulated seconds per second, and per second of the simulation's own core time, of one whole trial."""
    with ExitStack() as stack:
        begin_anew(served)
        if watched:
            stack.enter_context(watching(served))
        pid = served.simulation_pid()
        begun_s, begun_cpu_s = time.perf_counter(), cpu_s(pid)
        served.command(kind="set_paused", paused=False)
        while (state := served.state())["outcome"] is None:
            time.sleep(LOOK_S)
        t_s = float(str(state["t_s"]))
        return t_s / (time.perf_counter() - begun_s), t_s / (cpu_s(pid) - begun_cpu_s)


@contextmanager
def watching(served: Served) -> Generator[None]:
    """A viewer takes in whatever it is sent."""
    done = threading.Event()
    with view(served.authority) as viewer:

        def watch() -> None:
            while not done.is_set():
                viewer.receive(0.1)
                viewer.messages.clear()

        reader = threading.Thread(target=watch)
        reader.start()
        try:
            yield
        finally:
            done.set()
            reader.join()


def main() -> int:
    """Exit code 1 when the simulation loses more than it may."""
    parser = argparse.ArgumentParser(prog="python -m tests.app.measure_pace", description=__doc__)
    parser.add_argument("--times", type=int, default=5)
    parser.add_argument("--json", action="store_true", help="one JSON object instead of a table")
    options = parser.parse_args()
    alone: list[tuple[float, float]] = []
    watched: list[tuple[float, float]] = []
    flags = ("--paused", "--no-auto-next", "--no-tour", "--scenario", "ur5_linear")
    with serve(*flags, module=("run_server.py",)) as served:
        wait_for(served, lambda state: state["tick"] is not None, patience_s=60.0)
        served.command(kind="set_speed", speed=None)
        trial(served, watched=True)  # loads what is kept for the others
        for _ in range(options.times):
            alone.append(trial(served, watched=False))
            watched.append(trial(served, watched=True))
    rows: dict[str, float] = {}
    for i, of in enumerate(("wall", "core")):
        before, after = (statistics.median(run[i] for run in runs) for runs in (alone, watched))
        rows |= {f"alone_per_{of}_s": before, f"watched_per_{of}_s": after, f"lost_of_{of}": 1.0 - after / before}
    met = rows["lost_of_wall"] <= MOST_LOST
    if options.json:
        print(json.dumps(rows | {"met": met}))
    else:
        for name, value in rows.items():
            print(f"{name:20} {value:8.3f}" + (("  ok" if met else "  MISSED") if name == "lost_of_wall" else ""))
    return 0 if met else 1


if __name__ == "__main__":
    sys.exit(main())
