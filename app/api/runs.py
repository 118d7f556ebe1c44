"""Runs of grids: which there are, their rows and reports; begun, stopped and gone on with."""

from __future__ import annotations

from dataclasses import asdict
from typing import Annotated, Any, get_args

from fastapi import APIRouter, Body, Path, Query, Response

from app.api.run_models import (
    Choice,
    EstimateState,
    GridChoices,
    LinkedRow,
    ReportState,
    Row,
    RowPage,
    RowState,
    RowWish,
    RunList,
    RunState,
    RunSummary,
)
from app.permalink import address_of
from app.runs.again import Replay, link_to, replay_of, restart_of
from app.runs.look import Look
from app.runs.runs import Runs
from app.runs.shelf import NAME
from app.runs.words import NewRun, Workers, cores
from app.session import Session
from backend.errors import GraspingError
from backend.experiments.grid.cells import Key
from backend.experiments.grid.code import code_version
from backend.experiments.grid.estimate import Estimate
from backend.experiments.grid.settings import GridSettings, JudgeName
from backend.methods import METHODS
from backend.objects import object_names
from backend.robots import ROBOTS
from backend.robots.description import ProfileName
from backend.tasks import TASKS

RunName = Annotated[str, Path(pattern=NAME, description="Name of a folder among the runs.")]
Part = Annotated[str, Path(max_length=64)]
NEW: dict[str, Any] = {
    "small": {
        "summary": "Three methods on two tasks: 420 trials",
        "value": {
            "name": "first",
            "robots": ["ur5_robotiq"],
            "tasks": ["linear", "circular"],
            "methods": ["ours_rm", "reachability", "baseline"],
            "trials": 10,
        },
    },
    "paper": {"summary": "The paper's whole table: 58,800 trials", "value": {"name": "table1"}},
}


def runs_router(runs: Runs, session: Session) -> APIRouter:
    """Everything under /runs, and /grid."""
    router = APIRouter(tags=["runs"])

    @router.get("/grid")
    def choices() -> GridChoices:
        """What a new run may say."""
        return _choices()

    @router.get("/runs")
    def listed() -> RunList:
        """Every folder among the runs, also those that can't be read."""
        looks = runs.looks()
        return RunList(folder=str(runs.shelf.root), runs=[RunSummary(**_summary(runs, look)) for look in looks])

    @router.post("/runs", status_code=202)
    def start(
        response: Response,
        words: Annotated[NewRun, Body(openapi_examples=NEW)],
        dry_run: Annotated[bool, Query(description="Only say what it would come to.")] = False,
    ) -> EstimateState:
        """Begin a run, or go on with one of the same settings, in a process of its own beside this server.

        It ends with the server: trials under way are finished, and it can be gone on with.
        """
        if dry_run:
            response.status_code = 200
        return _estimate(runs.estimate(words) if dry_run else runs.start(words), words.workers)

    @router.get("/runs/{name}")
    def one(name: RunName) -> RunState:
        """Settings, progress, and how each cell went so far."""
        return _state(runs, runs.look(name))

    @router.post("/runs/{name}/go-on", status_code=202)
    def go_on(name: RunName, workers: Annotated[Workers | None, Body(embed=True, examples=[2])] = None) -> RunState:
        """Run the trials that are missing."""
        runs.go_on(name, workers)
        return _state(runs, runs.look(name))

    @router.post("/runs/{name}/stop", status_code=202)
    def stop(name: RunName) -> RunState:
        """Let the trials under way be the last. Asked once more, they are dropped."""
        runs.process.stop(name)
        return _state(runs, runs.look(name))

    @router.get("/runs/{name}/rows")
    def rows(name: RunName, wish: Annotated[RowWish, Query()]) -> RowPage:
        """The rows that fit, page by page."""
        total, found = runs.rows(name, wish.wanted(), wish.offset, wish.limit, wish.order)
        try:
            plan = runs.plan(name)
        except GraspingError:
            plan = None
        rows = [LinkedRow(**asdict(row), link=None if plan is None else link_to(plan, row)) for row in found]
        return RowPage(total=total, offset=wish.offset, rows=rows)

    @router.get("/runs/{name}/rows/{robot}/{task}/{object}/{method}/{index}")
    def row(
        name: RunName,
        robot: Part,
        task: Part,
        object: Part,
        method: Part,
        index: Annotated[int, Path(ge=0, le=1_000_000)],
    ) -> RowState:
        """One trial, and where it can be seen."""
        found = runs.row(name, Key(robot, task, object, method, index))
        link, why = None, ""
        replay: Replay = "elsewhere"
        try:
            restart = restart_of(runs.plan(name), found)
            link, replay = address_of(restart), replay_of(restart, found, session.state)
        except GraspingError as error:
            why = str(error)
        other = found.code != code_version()
        return RowState(row=Row.model_validate(found), link=link, no_link=why, replay=replay, other_code=other)

    @router.get("/runs/{name}/report")
    def report(name: RunName, judge: JudgeName | None = None) -> ReportState:
        """Tables and figures of the rows there are; takes some seconds when rows have come since the last time."""
        kept = runs.report(name, judge)
        return ReportState(rows=kept.rows, judge=kept.judge, **kept.report)

    return router


def _summary(runs: Runs, look: Look) -> dict[str, Any]:
    return {
        **{name: getattr(look, name) for name in ("name", "state", "note", "trials", "done", "errors", "judge")},
        "successes": look.successes(),
        "own": runs.process.runs(look.name),
        "stopping": runs.process.stopping(look.name),
        "per_s": look.pace.per_s,
        "left_s": look.pace.left_s,
        "last_words": runs.process.last_words(look.name),
    }


def _state(runs: Runs, look: Look) -> RunState:
    decided = {} if look.facts is None else look.facts.decided
    return RunState.model_validate(
        {
            **_summary(runs, look),
            "settings": {name: value for name, value in decided.items() if name != "conditions"},
            "cells": [asdict(cell) for cell in look.cells],
            "reasons": dict(look.reasons),
        }
    )


def _estimate(found: Estimate, workers: int | None) -> EstimateState:
    time = found.duration
    return EstimateState(
        trials=found.trials,
        done=found.done,
        hours=time.hours,
        words=time.words,
        source=time.source,
        workers=workers or cores(),
    )


def _choices() -> GridChoices:
    usual = GridSettings()
    tables: dict[str, dict[str, str]] = {
        "robots": {name: robot.title for name, robot in ROBOTS.items()},
        "tasks": {name: task.title for name, task in TASKS.items()},
        "objects": {name: name.replace("_", " ") for name in object_names()},
        "methods": {name: method.title for name, method in METHODS.items()},
    }
    listed = {
        word: [Choice(name=name, title=title, usual=name in getattr(usual, word)) for name, title in table.items()]
        for word, table in tables.items()
    }
    return GridChoices(
        **listed,
        trials=usual.trials,
        profiles=list(get_args(ProfileName)),
        thinks=["budget", "paper"],
        judges=list(get_args(JudgeName)),
        cores=cores(),
    )
