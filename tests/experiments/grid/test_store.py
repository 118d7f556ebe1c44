"""Rows are written once and whole, read while others write, and a broken file is called broken."""

import json
import sqlite3
from pathlib import Path

import pytest

from backend.errors import InvalidInputError, NotFoundError, StorageError
from backend.experiments.grid.folder import facts_of, parse_shard, plan_of, read_grid
from backend.experiments.grid.merging import merge
from backend.experiments.grid.settings import hash_of
from backend.experiments.grid.store import read_store
from tests.experiments.grid.making import all_jobs, key, plan, row_of, store_in


def fill(folder: Path, trials: int, name: str = "grid.sqlite", skip: int = 0, **changes: object) -> None:
    of = plan(trials=trials, **changes)
    with store_in(folder, of, name) as store:
        for job in all_jobs(of)[skip:]:
            store.add(row_of(job))


def test_rows_come_back_as_they_were_written(tmp_path: Path):
    rows = [row_of(job) for job in all_jobs(plan())]
    with store_in(tmp_path) as store:
        for row in rows:
            store.add(row)
        assert list(store.rows()) == rows
        assert store.keys() == {row.key for row in rows}
        assert store.row(key(2)) == rows[4]
        with pytest.raises(NotFoundError, match="no row of ur5_robotiq/linear/cube/ik/9"):
            store.row(key(9))


def test_a_row_is_written_once(tmp_path: Path):
    row = row_of(all_jobs(plan())[0])
    with store_in(tmp_path) as store:
        store.add(row)
        with pytest.raises(InvalidInputError, match="UNIQUE"):
            store.add(row)
        assert list(store.rows()) == [row]


def test_readers_see_rows_while_the_grid_runs(tmp_path: Path):
    with store_in(tmp_path) as store:
        for n, job in enumerate(all_jobs(plan())[:3], start=1):
            store.add(row_of(job))
            with read_grid(tmp_path) as reader:
                assert len(list(reader.rows())) == n
        with pytest.raises(InvalidInputError, match="Another grid is writing"):
            store_in(tmp_path)


def test_other_settings_are_refused_with_the_difference(tmp_path: Path):
    fill(tmp_path, 4)
    with pytest.raises(InvalidInputError, match="trials: 4 there, 3 asked for"):
        store_in(tmp_path, plan(trials=3))
    with pytest.raises(InvalidInputError, match="first_seed: 0 there, 1 asked for"):
        store_in(tmp_path, plan(trials=5, first_seed=1))
    with store_in(tmp_path, plan(trials=4, judge="authors")) as store:
        assert len(store.keys()) == 8


def test_the_plan_is_made_again_from_the_store(tmp_path: Path):
    fill(tmp_path, 4)
    with read_grid(tmp_path) as store:
        assert plan_of(store.facts).decided() == plan(trials=4).decided()


def test_a_folder_that_cannot_be_written_is_named(tmp_path: Path):
    (tmp_path / "file").write_text("")
    with pytest.raises(InvalidInputError, match=r"Cannot write to the folder .*file/below"):
        store_in(tmp_path / "file" / "below")


def test_a_full_disk_loses_nothing_that_is_there(tmp_path: Path):
    of = plan(trials=1000)
    jobs = iter(all_jobs(of))
    with store_in(tmp_path, of) as store:
        store._db.execute("PRAGMA max_page_count = 30")  # pyright: ignore[reportPrivateUsage]
        written = 0
        with pytest.raises(StorageError, match=r"disk full\? What was written is kept"):
            while True:
                store.add(row_of(next(jobs)))
                written += 1
        assert 0 < written == len(store.keys())
    with store_in(tmp_path, of) as store:
        store.add(row_of(next(jobs)))
        assert len(store.keys()) == written + 1


def test_a_file_that_is_no_database_is_called_corrupt(tmp_path: Path):
    (tmp_path / "grid.sqlite").write_text("nonsense " * 100)
    with pytest.raises(InvalidInputError, match=r"is corrupt .*--salvage"):
        read_grid(tmp_path)
    with pytest.raises(InvalidInputError, match="is corrupt"):
        store_in(tmp_path)


def test_what_can_be_read_of_a_corrupt_file_is_salvaged(tmp_path: Path):
    old, new = tmp_path / "old", tmp_path / "new"
    fill(old, 200)
    file = old / "grid.sqlite"
    content = bytearray(file.read_bytes())
    middle = len(content) // 4096 // 2 * 4096
    content[middle : middle + 4096] = b"\xff" * 4096
    file.write_bytes(content)
    with pytest.raises(InvalidInputError, match="is corrupt"):
        read_grid(old)
    merged = merge(new, [old], salvage=True)
    assert 200 <= merged.added < 400
    with read_grid(new) as store:
        by_key = {job.key: row_of(job) for job in all_jobs(plan(trials=200))}
        assert all(by_key[row.key] == row for row in store.rows())


def test_shards_are_merged_once_and_whole(tmp_path: Path):
    of = plan(trials=6)
    for i in (1, 2, 3):
        with store_in(tmp_path, of, f"shard-{i}-of-3.sqlite") as store:
            for job in of.jobs(lambda _: True, (i, 3)):
                store.add(row_of(job))
    with pytest.raises(NotFoundError, match="3 shards that are not merged yet"):
        read_grid(tmp_path)
    assert merge(tmp_path, []).added == 12
    assert merge(tmp_path, []).there_already == 12
    with read_grid(tmp_path) as store:
        assert sorted(row.key for row in store.rows()) == sorted(job.key for job in all_jobs(of))


def test_rows_that_contradict_each_other_are_not_merged(tmp_path: Path):
    fill(tmp_path / "a", 2)
    fill(tmp_path / "b", 2)
    with sqlite3.connect(tmp_path / "b" / "grid.sqlite") as db:
        db.execute("UPDATE trials SET fingerprint = 'other' WHERE rowid = 2")
    db.close()
    with pytest.raises(InvalidInputError, match="different rows of ur5_robotiq/linear/cube/baseline/0"):
        merge(tmp_path / "a", [tmp_path / "b"])


def test_grids_of_other_settings_are_not_merged(tmp_path: Path):
    fill(tmp_path / "a", 2)
    fill(tmp_path / "b", 2, first_seed=7)
    for target, others in (("a", ["b"]), ("new", ["a", "b"])):
        with pytest.raises(InvalidInputError, match=r"first_seed: \d there, \d asked for"):
            merge(tmp_path / target, [tmp_path / other for other in others])
    with pytest.raises(NotFoundError, match="no rows of a grid"):
        merge(tmp_path / "a", [tmp_path / "none"])


def test_more_trials_go_on_with_those_there_are_and_all_have_the_same_settings(tmp_path: Path):
    fill(tmp_path / "a", 2)
    with store_in(tmp_path / "a", plan(trials=5)) as store:
        assert store.keys() == {job.key for job in all_jobs(plan(trials=2))}
        assert store.facts.settings == hash_of(plan(trials=2).decided())
    with read_grid(tmp_path / "a") as store:
        assert store.facts.decided == plan(trials=5).decided()
        assert store.facts.settings == hash_of(plan(trials=2).decided())


@pytest.mark.parametrize("others", [["a", "b"], ["b", "a"]])
def test_what_has_more_trials_takes_in_what_has_fewer(tmp_path: Path, others: list[str]):
    fill(tmp_path / "a", 2)
    fill(tmp_path / "b", 3)
    merged = merge(tmp_path / "new", [tmp_path / other for other in others])
    assert (merged.added, merged.there_already) == (6, 4)
    again = merge(tmp_path / "b", [tmp_path / "a"])
    assert (again.added, again.there_already) == (0, 4)


def test_settings_that_have_come_since_are_no_difference_at_their_defaults(tmp_path: Path):
    fill(tmp_path, 2)
    of_long_ago = plan(trials=2).decided()
    for cell in of_long_ago["conditions"].values():
        del cell["method"]["rehearsal"]
    with sqlite3.connect(tmp_path / "grid.sqlite") as db:
        db.execute("UPDATE facts SET value = ? WHERE name = 'decided'", (json.dumps(of_long_ago),))
    db.close()
    with store_in(tmp_path, plan(trials=2)) as store:
        assert plan_of(store.facts).decided() == plan(trials=2).decided()
    with pytest.raises(InvalidInputError, match="set"):
        store_in(tmp_path, plan(trials=2, set=("method.rehearsal=false",)))


def test_another_format_is_not_guessed_at(tmp_path: Path):
    fill(tmp_path, 1)
    with sqlite3.connect(tmp_path / "grid.sqlite") as db:
        db.execute("UPDATE facts SET value = ? WHERE name = 'format'", (json.dumps(99),))
    db.close()
    with pytest.raises(InvalidInputError, match="format 99"):
        read_store(tmp_path / "grid.sqlite")


def test_a_store_says_what_it_is_of(tmp_path: Path):
    with store_in(tmp_path) as store:
        assert store.facts == facts_of(plan(), None)
        assert store.codes() == set()


@pytest.mark.parametrize("text", ["", "1", "0/4", "5/4", "a/b", "1/4/2"])
def test_a_shard_is_i_of_n(text: str):
    assert parse_shard("2/4") == (2, 4)
    with pytest.raises(InvalidInputError, match="i/n"):
        parse_shard(text)
