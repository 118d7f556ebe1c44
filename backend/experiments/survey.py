"""Survey: success of scenarios x objects x seeds, with the reasons of every failure."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

from backend.experiments.trial import run_trial
from backend.parallel import spread
from backend.record import TrialRecord
from backend.scenario import Scenario


@dataclass(frozen=True)
class Job:
    """One trial to run."""

    name: str
    scenario: Scenario
    seed: int


@dataclass(frozen=True)
class Row:
    """One trial that was run."""

    name: str
    record: TrialRecord


def run_jobs(jobs: Iterable[Job], workers: int) -> Iterator[Row]:
    """Run every job in spawned processes; rows come as they are done."""
    return spread(_run, jobs, workers)


def _run(job: Job) -> Row:
    return Row(job.name, run_trial(job.scenario, job.seed))


def summary(rows: list[Row], key: Callable[[Row], str]) -> list[dict[str, object]]:
    """One line per value of ``key``: n, both success rates, mean times, and how often each reason."""
    groups: dict[str, list[TrialRecord]] = {}
    for row in sorted(rows, key=key):
        groups.setdefault(key(row), []).append(row.record)
    return [{"name": name, **_line(records)} for name, records in groups.items()]


def _line(records: list[TrialRecord]) -> dict[str, object]:
    n = len(records)
    lifts = [r.lift_end_s for r in records if r.strict and r.lift_end_s is not None]
    reasons = Counter(r.reason for r in records if r.reason is not None)
    return {
        "n": n,
        "strict": sum(r.strict for r in records) / n,
        "authors": sum(r.authors for r in records) / n,
        "lift_end_s": sum(lifts) / len(lifts) if lifts else None,
        "reasons": dict(reasons.most_common()),
    }
