"""``grid``: run the trials of a grid that have no row yet, side by side, and keep each as a row."""

import argparse
import json
import os
import signal
import sys
from collections.abc import Callable, Generator, Iterator
from contextlib import contextmanager
from types import FrameType

from backend.cli.grid_words import Asked, asked_for
from backend.cli.progress import Progress
from backend.errors import StorageError
from backend.experiments.executors.executor import Executor
from backend.experiments.grid.cells import Job
from backend.experiments.grid.code import code_version
from backend.experiments.grid.driver import Stop, drive
from backend.experiments.grid.estimate import estimate_of
from backend.experiments.grid.folder import open_grid
from backend.experiments.grid.store import Store
from backend.experiments.grid.work import run_job


def run(options: argparse.Namespace) -> int:
    """0 when every trial has a row, 1 when it was stopped before."""
    asked = asked_for(options)
    workers = _workers(asked)
    if options.dry_run:
        return _dry_run(asked, workers, options.json)
    with open_grid(asked.folder, asked.plan, asked.trial_set, asked.shard) as store:
        done = store.keys()
        jobs = list(asked.plan.jobs(lambda key: key not in done, asked.shard))
        total = len(jobs) + len(done)
        if done:
            _say(f"{len(done)} of {total} trials are there already.")
            _warn_of_other_code(store)
        complete = not jobs or _run(asked, workers, store, iter(jobs), total)
        there = len(store.keys())
        if options.json:
            print(json.dumps({"rows": there, "trials": total, "store": str(store.path)}))
        if not complete:
            _say(f"Stopped; {there} of {total} rows are kept. The same command goes on from here.")
            return 1
    _say(f"All {total} trials have a row in {store.path}. {_next(asked)}")
    return 0


def _run(asked: Asked, workers: int, store: Store, jobs: Iterator[Job], total: int) -> bool:
    """Whether all jobs were run."""
    executor = _executor(asked, workers, store)
    try:
        progress = Progress(total, store, asked.plan.settings.judge)
        with _interrupts(progress.tell) as stop:
            return drive(jobs, executor, store, stop, progress.row)
    except StorageError as error:
        raise StorageError(f"{error} Make room; the same command goes on from here.") from error
    finally:
        executor.close()


def _executor(asked: Asked, workers: int, store: Store) -> Executor:
    words, settings = asked.words, store.facts.settings
    if words.executor == "ray":
        from backend.experiments.executors.ray import RayExecutor

        here = words.ray_address is None
        return RayExecutor(run_job, settings, workers if here else words.workers, words.limit_s, words.ray_address)
    from backend.experiments.executors.local import LocalExecutor

    return LocalExecutor(run_job, settings, workers, words.limit_s)


def _workers(asked: Asked) -> int:
    cores = os.cpu_count() or 1
    workers = asked.words.workers or cores
    if workers > cores and asked.words.executor == "local":
        _say(f"Warning: {workers} workers share {cores} cores; more than one per core are not faster together.")
    return workers


def _dry_run(asked: Asked, workers: int, as_json: bool) -> int:
    """Say how many trials there would be and how long they would take; nothing is written."""
    found = estimate_of(asked.plan, asked.folder, workers, asked.shard)
    time = found.duration
    if as_json:
        print(json.dumps({"trials": found.trials, "done": found.done, "hours": time.hours, "each_s": time.each_s}))
        return 0
    s = asked.plan.settings
    print(f"{found.trials} trials, {found.done} of them done; the others take {time.words} on {workers} workers")
    print(f"  ({time.source}).")
    for name in ("robots", "tasks", "objects", "methods"):
        listed: tuple[str, ...] = getattr(s, name)
        print(f"  {len(listed)} {name:<8} {', '.join(listed)}")
    print(f"  speeds `{s.profile}`, charge `{s.think}`{''.join(f', {value}' for value in s.set)}")
    return 0


@contextmanager
def _interrupts(tell: Callable[[str], None]) -> Generator[Stop]:
    """Ctrl-C, or a job queue's SIGTERM, wants a stop; another Ctrl-C ends at once."""
    stop = Stop()

    def ask(number: int, frame: FrameType | None) -> None:
        if stop.wanted:
            raise KeyboardInterrupt
        stop.wanted = True
        tell("Stopping: the trials under way are finished first. Once more ends at once.")

    before = {number: signal.signal(number, ask) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield stop
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)


def _warn_of_other_code(store: Store) -> None:
    made_with = store.codes()
    if made_with - {code_version()}:
        _say(f"Warning: rows here were made with {', '.join(sorted(made_with))}, new ones are with {code_version()}.")


def _next(asked: Asked) -> str:
    if asked.shard[1] > 1:
        return f"When all shards are done: python -m backend merge {asked.folder}"
    return f"Next: python -m backend report {asked.folder}"


def _say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)
