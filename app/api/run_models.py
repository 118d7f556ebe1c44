"""What the API says of runs, as models with examples."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, JsonValue

from app.runs.again import Replay
from app.runs.look import State
from backend.experiments.grid.queries import MOST_ROWS, Order, Wanted
from backend.experiments.grid.settings import JudgeName

Word = Annotated[str | None, Field(max_length=64)]
RUNNING: dict[str, JsonValue] = {
    "name": "table1",
    "state": "running",
    "note": "",
    "trials": 58800,
    "done": 1200,
    "successes": 1012,
    "errors": 0,
    "judge": "strict",
    "own": True,
    "stopping": False,
    "per_s": 1.6,
    "left_s": 36000.0,
    "last_words": "",
}
ESTIMATED: dict[str, JsonValue] = {
    "trials": 420,
    "done": 0,
    "hours": 0.07,
    "words": "about 4 min",
    "source": "1.2 s each, as on a core of a server of 2024",
    "workers": 2,
}


class Answer(BaseModel):
    """What stands below a field in quotes is its description in the API's documentation."""

    model_config = ConfigDict(use_attribute_docstrings=True)


class RunSummary(Answer):
    """One run, as the list has it."""

    model_config = ConfigDict(json_schema_extra={"examples": [RUNNING]})

    name: str
    state: State
    """`running`; `stopped`, which can be gone on with; `complete`; `unreadable`: broken, or of another version;
    `foreign`: a folder without a grid."""
    note: str
    """Why it can't be read, or what is going on."""
    trials: int
    done: int
    successes: int
    """Of those done, by `judge`."""
    errors: int
    judge: JudgeName
    own: bool
    """Whether this server runs it, so that it can be stopped here."""
    stopping: bool
    """A stop has been asked for; the trials under way are finished."""
    per_s: float | None
    """Trials a second, of late; null while nothing runs or too few have come."""
    left_s: float | None
    """Until it is done, if it goes on so."""
    last_words: str
    """What the grid said when it ended by an error."""


class RunList(Answer):
    """Answer of /runs."""

    folder: str
    """Where the runs lie."""
    runs: list[RunSummary]


class CellState(Answer):
    """How the trials of one robot, task and method went so far."""

    robot: str
    task: str
    method: str
    n: int
    strict: int
    """Successes by the strict rule."""
    authors: int
    errors: int


class RunState(RunSummary):
    """Answer of /runs/{name}."""

    settings: dict[str, Any]
    """The words of the grid; empty of a run that can't be read."""
    cells: list[CellState]
    reasons: dict[str, int]
    """How often each reason of failure by the strict rule, the most frequent first."""


class Row(Answer):
    """One trial."""

    model_config = ConfigDict(from_attributes=True)

    robot: str
    task: str
    object: str
    method: str
    index: int
    seed: int
    strict: bool
    authors: bool
    reason: str | None
    detail: str
    approach_start_s: float | None
    lift_end_s: float | None
    end_s: float | None
    cycles: int
    cycle_mean_ms: float | None
    cycle_p95_ms: float | None
    joint_path_rad: float | None
    distance_m: float | None
    speed_mps: float | None
    fingerprint: str
    wall_s: float | None
    attempts: int
    code: str
    machine: str
    finished: str


class LinkedRow(Row):
    """One trial of a list."""

    link: str | None
    """Address on this server that opens exactly this trial in the scene; null where there is none."""


class RowWish(Answer):
    """Which rows, and how many of them."""

    model_config = ConfigDict(extra="forbid")

    robot: Word = None
    task: Word = None
    object: Word = None
    method: Word = None
    outcome: Literal["success", "failure"] | None = None
    """By `judge`."""
    reason: Word = None
    """That of the strict rule."""
    judge: JudgeName = "strict"
    order: Order = "key"
    offset: Annotated[int, Field(ge=0, le=100_000_000)] = 0
    limit: Annotated[int, Field(ge=1, le=MOST_ROWS)] = 50

    def wanted(self) -> Wanted:
        """As the store is asked."""
        success = None if self.outcome is None else self.outcome == "success"
        return Wanted(self.robot, self.task, self.object, self.method, success, self.reason, self.judge)


class RowPage(Answer):
    """Answer of /runs/{name}/rows."""

    total: int
    """Rows that fit the filter."""
    offset: int
    rows: list[LinkedRow]


class RowState(Answer):
    """Answer of /runs/{name}/rows/{key}."""

    row: Row
    link: str | None
    """Address on this server that opens exactly this trial in the scene; null where there is none."""
    no_link: str
    """Why there is none."""
    replay: Replay
    """Whether the page's own trial is this one, and if it has ended, whether outcome and fingerprint are the row's."""
    other_code: bool
    """The row was made with other code than this server's, so the replay may come out otherwise."""


class EstimateState(Answer):
    """What a grid would come to."""

    model_config = ConfigDict(json_schema_extra={"examples": [ESTIMATED]})

    trials: int
    done: int
    """Rows that are there already."""
    hours: float
    """Of those that are missing."""
    words: str
    source: str
    workers: int


class ReportState(Answer):
    """Answer of /runs/{name}/report."""

    rows: int
    judge: JudgeName
    facts: list[str]
    tables: list[dict[str, Any]]
    """Each with name, title, header, lines, note; `papers`: laid out as the paper's, `folded`: long."""
    figures: list[dict[str, Any]]
    """Each with Plotly's data and layout."""


class Choice(Answer):
    """A name and what it means."""

    name: str
    title: str
    usual: bool
    """Whether a grid has it unless told otherwise."""


class GridChoices(Answer):
    """Answer of /grid: what a new run may say."""

    robots: list[Choice]
    tasks: list[Choice]
    objects: list[Choice]
    methods: list[Choice]
    trials: int
    profiles: list[str]
    thinks: list[str]
    judges: list[str]
    cores: int
