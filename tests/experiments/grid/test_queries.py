"""What readers ask of a store, against the same worked out row by row; and who writes to it."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Literal

import pytest
from hypothesis import given
from hypothesis import strategies as st

from backend.errors import InvalidInputError
from backend.experiments.grid.folder import trials_of
from backend.experiments.grid.queries import (
    MOST_ROWS,
    RECENT_S,
    Wanted,
    cell_counts,
    pace_of,
    page_of,
    reason_counts,
    rows_so_far,
)
from backend.experiments.grid.row import GridRow
from backend.experiments.grid.store import Store
from backend.experiments.grid.writer import writing_since
from tests.experiments.grid.making import all_jobs, plan, row_of, store_in

OF = plan(
    robots=("ur5_robotiq", "mico"),
    tasks=("linear", "circular"),
    objects=("cube", "sugar_box"),
    methods=("ik", "baseline"),
)
REASONS = (None, "timeout", "dropped", "error")


def rows() -> list[GridRow]:
    out: list[GridRow] = []
    for i, job in enumerate(all_jobs(OF)):
        reason = REASONS[i % 7 % 4]
        out.append(replace(row_of(job), strict=reason is None, authors=i % 3 == 0, reason=reason))
    return out


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Store]:
    with store_in(tmp_path_factory.mktemp("grid"), OF) as store:
        for row in rows():
            store.add(row)
        yield store


def test_every_row_is_counted_in_its_cell(store: Store):
    counts = {(c.robot, c.task, c.method): (c.n, c.strict, c.authors, c.errors) for c in cell_counts(store)}
    own: dict[tuple[str, str, str], list[GridRow]] = {}
    for row in rows():
        own.setdefault((row.robot, row.task, row.method), []).append(row)
    assert counts == {
        key: (len(r), sum(x.strict for x in r), sum(x.authors for x in r), sum(x.reason == "error" for x in r))
        for key, r in own.items()
    }
    assert reason_counts(store) == Counter(row.reason for row in rows() if row.reason)
    assert trials_of(store.facts) == OF.trials == len(rows()) == rows_so_far(store)


WISHES = st.builds(
    Wanted,
    robot=st.sampled_from([None, "mico", "nobody"]),
    task=st.sampled_from([None, "linear", "' OR 1 --"]),
    object=st.sampled_from([None, "cube"]),
    method=st.sampled_from([None, "ik"]),
    success=st.sampled_from([None, True, False]),
    reason=st.sampled_from([None, "dropped"]),
    judge=st.sampled_from(["strict", "authors"]),
)


@given(WISHES, st.sampled_from(["key", "newest"]))
def test_a_filter_keeps_what_fits_and_pages_lose_nothing(store: Store, wanted: Wanted, order: Literal["key", "newest"]):
    fitting = [
        row
        for row in rows()
        if all(
            getattr(wanted, name) in (None, getattr(row, name))
            for name in ("robot", "task", "object", "method", "reason")
        )
        and wanted.success in (None, getattr(row, wanted.judge))
    ]
    total, _ = page_of(store, wanted)
    pages = [page_of(store, wanted, offset, 7, order)[1] for offset in range(0, total + 7, 7)]
    found = [row for page in pages for row in page]
    assert total == len(fitting) == len(found)
    assert {row.key for row in found} == {row.key for row in fitting}
    expected = sorted(fitting, key=lambda row: row.key) if order == "key" else fitting[::-1]
    assert found == expected


def test_a_page_is_never_longer_than_the_most(store: Store):
    assert len(page_of(store, Wanted(), limit=10**9)[1]) <= MOST_ROWS
    assert page_of(store, Wanted(), offset=-5, limit=-1) == (len(rows()), [])


def stamp(posix_s: float) -> str:
    return datetime.fromtimestamp(posix_s, UTC).strftime("%Y-%m-%dT%H:%M:%SZ")


def test_the_pace_is_that_of_this_run_and_of_late(tmp_path: Path):
    now_s = 1_800_000_000.0
    jobs = iter(all_jobs(OF))
    with store_in(tmp_path, OF) as store:
        assert pace_of(store, 10, now_s - 100.0, now_s).per_s is None
        for i in range(5):  # long ago
            store.add(replace(row_of(next(jobs)), finished=stamp(now_s - 10 * RECENT_S - i)))
        assert pace_of(store, 10, now_s - 20 * RECENT_S, now_s).per_s is None
        for i in range(21):
            store.add(replace(row_of(next(jobs)), finished=stamp(now_s - 40.0 + 2.0 * i)))
        pace = pace_of(store, 10, now_s - 50.0, now_s)
        assert pace.per_s == pytest.approx(0.5) and pace.left_s == pytest.approx(20.0)
        stalled = pace_of(store, 10, now_s - 50.0, now_s + 100.0)
        assert stalled.per_s is not None and stalled.per_s < 0.2


def test_whoever_asks_sees_that_somebody_writes_and_is_not_in_the_way(tmp_path: Path):
    path = tmp_path / "grid.sqlite"
    assert writing_since(path) is None
    with store_in(tmp_path, OF):
        since_s = writing_since(path)
        assert since_s is not None
        with pytest.raises(InvalidInputError, match="Another grid is writing"):
            store_in(tmp_path, OF)
        assert writing_since(path) == since_s
    assert writing_since(path) is None
    for _ in range(20):
        assert writing_since(path) is None
        store_in(tmp_path, OF).close()
