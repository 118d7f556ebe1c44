"""Runs: all grids in one folder, and everything that the page and the API may ask of them."""

from __future__ import annotations

import time
from collections import OrderedDict
from dataclasses import replace
from pathlib import Path
from threading import Lock

from app.runs.look import Look, look_at
from app.runs.process import BusyError, GridProcess
from app.runs.report import Kept, Reports
from app.runs.shelf import Shelf
from app.runs.words import NewRun, cores, grid_file, grid_file_of
from backend.errors import InvalidInputError
from backend.experiments.grid.cells import Key, Plan
from backend.experiments.grid.estimate import Estimate, estimate_of
from backend.experiments.grid.folder import plan_of, read_grid, store_file
from backend.experiments.grid.queries import Order, Wanted, page_of, rows_so_far
from backend.experiments.grid.row import GridRow
from backend.experiments.grid.settings import JudgeName, hash_of
from backend.experiments.grid.store import Facts
from backend.experiments.grid.writer import writing_since

PLANS_KEPT = 8


class Runs:
    """Reads whatever is there; begins and stops what the page itself runs."""

    def __init__(self, root: Path) -> None:
        self.shelf = Shelf(root)
        self.process = GridProcess()
        self._reports = Reports()
        self._looks: dict[str, Look] = {}
        self._plans: OrderedDict[str, Plan] = OrderedDict()
        self._lock = Lock()

    def close(self) -> None:
        """End what the page runs; trials under way are finished first."""
        self._reports.close()
        self.process.close()

    def looks(self) -> list[Look]:
        """Every run, by name."""
        return [self.look(name) for name in self.shelf.names()]

    def look(self, name: str) -> Look:
        """What is known of a run; raises ``NotFoundError``."""
        look = self._looks[name] = look_at(self.shelf.path(name), time.time(), self._looks.get(name))
        if look.state in ("foreign", "stopped") and self.process.runs(name):
            look = replace(look, state="running", note="It is starting.")
        return look

    def rows(self, name: str, wanted: Wanted, offset: int, limit: int, order: Order) -> tuple[int, list[GridRow]]:
        """A page of rows, and how many there are of them; raises ``GraspingError``."""
        with read_grid(self.shelf.path(name), check=False) as store:
            return page_of(store, wanted, offset, limit, order)

    def row(self, name: str, key: Key) -> GridRow:
        """The row of a trial; raises ``GraspingError``."""
        with read_grid(self.shelf.path(name), check=False) as store:
            return store.row(key)

    def plan(self, name: str) -> Plan:
        """The trials of a run; raises ``GraspingError`` when this project is not the one they were made with."""
        return self._plan(self._facts(name))

    def report(self, name: str, judge: JudgeName | None) -> Kept:
        """Tables and figures of the rows there are; raises ``GraspingError``."""
        path = self.shelf.path(name)
        with read_grid(path, check=False) as store:
            rows = rows_so_far(store)
        return self._reports.report(path, judge or self.look(name).judge, rows)

    def estimate(self, words: NewRun) -> Estimate:
        """What a grid would come to; raises ``GraspingError`` when it can't be run. Nothing is written."""
        return estimate_of(words.plan(), self.shelf.new_path(words.name), words.workers or cores())

    def start(self, words: NewRun) -> Estimate:
        """Begin a grid, or go on with one of the same settings; raises ``GraspingError``."""
        plan, folder = words.plan(), self.shelf.new_path(words.name)
        found = estimate_of(plan, folder, words.workers or cores())
        self._refuse_if_written(folder)
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise InvalidInputError(f"The folder {folder} cannot be made: {error.strerror}.") from None
        self.process.start(folder, grid_file_of(plan), None, words.workers)
        return found

    def go_on(self, name: str, workers: int | None) -> None:
        """Run the trials that a run lacks; raises ``GraspingError``."""
        folder = self.shelf.path(name)
        facts = self._facts(name)
        self._plan(facts)  # says so when this project's scenarios are not those of the rows
        self._refuse_if_written(folder)
        self.process.start(folder, grid_file(facts), facts.trial_set, workers)

    def _refuse_if_written(self, folder: Path) -> None:
        if writing_since(store_file(folder)) is not None and not self.process.runs(folder.name):
            raise BusyError(f"Another grid is writing to {folder.name}; wait for it or take another name.")

    def _facts(self, name: str) -> Facts:
        with read_grid(self.shelf.path(name), check=False) as store:
            return store.facts

    def _plan(self, facts: Facts) -> Plan:
        """Made once: a plan of all cells takes a moment."""
        with self._lock:
            key = hash_of(facts.decided)
            plan = self._plans.pop(key, None) or plan_of(facts)
            self._plans[key] = plan
            while len(self._plans) > PLANS_KEPT:
                self._plans.popitem(last=False)
            return plan
