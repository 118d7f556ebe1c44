"""Laws of what the page knows of runs: nothing leads out of their folder, what is broken is told, links are exact."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from urllib.parse import parse_qsl, urlsplit

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.api.run_models import Row
from app.commands import Restart
from app.engine import Keepsake, info_of
from app.live_episode import LiveEpisode
from app.permalink import trial_at
from app.reports import Pace
from app.runs.again import link_to, replay_of, restart_of
from app.runs.look import look_at
from app.runs.runs import Runs
from app.runs.shelf import Shelf
from app.runs.words import NewRun, grid_file, grid_file_of
from app.state import SessionState
from app.wanted import scenario_of
from backend.errors import GraspingError, InvalidInputError, NotFoundError
from backend.experiments.grid.cells import make_plan
from backend.experiments.grid.folder import facts_of
from backend.experiments.grid.row import GridRow
from backend.experiments.grid.settings import GridSettings, read_grid_file, settings_from
from backend.experiments.grid.store import open_store
from backend.experiments.grid.trial_set import drawn_set, sha256_of, starts_of, to_csv
from backend.experiments.grid.work import run_job
from backend.methods import METHODS
from backend.scenario import load_scenario
from tests.experiments.grid.making import all_jobs, plan, row_of, store_in

NOW_S = 1_800_000_000.0
OF = plan(trials=3)


@given(st.text(max_size=80))
def test_no_name_leads_out_of_the_folder(name: str):
    shelf = Shelf(Path("/nowhere/runs"))
    with pytest.raises(NotFoundError, match="no run named"):
        shelf.path(name)
    try:
        path = shelf.new_path(name)
    except InvalidInputError as refused:
        assert "letters, digits" in str(refused)
    else:
        assert path.parent == shelf.root and path.resolve() == path and not name.startswith(".")


@pytest.mark.parametrize("name", ["", "..", ".hidden", "a/b", "a\\b", "a" * 65, "a\n", "-x", "a b", "ä"])
def test_odd_names_are_refused(name: str):
    with pytest.raises(InvalidInputError):
        Shelf(Path("/nowhere")).new_path(name)


def test_a_link_out_of_the_folder_is_no_run(tmp_path: Path):
    (tmp_path / "elsewhere").mkdir()
    runs = tmp_path / "runs"
    (runs / "own").mkdir(parents=True)
    (runs / "away").symlink_to(tmp_path / "elsewhere")
    (runs / "file").write_text("")
    shelf = Shelf(runs)
    assert shelf.names() == ["own"]
    with pytest.raises(InvalidInputError):
        shelf.new_path("away")


def test_a_run_is_looked_at_whatever_it_is(tmp_path: Path):
    for name in ("empty", "half", "whole", "garbage", "cut", "shards"):
        (tmp_path / name).mkdir()
    jobs = all_jobs(OF)
    for name, count in (("half", 2), ("whole", 6), ("cut", 6)):
        with store_in(tmp_path / name, OF) as store:
            for job in jobs[:count]:
                store.add(row_of(job))
    (tmp_path / "garbage" / "grid.sqlite").write_bytes(b"this is no database at all" * 100)
    cut = tmp_path / "cut" / "grid.sqlite"
    cut.write_bytes(cut.read_bytes()[:4096] + b"\xff" * 8192)
    store_in(tmp_path / "shards", OF, "shard-1-of-2.sqlite").close()
    looks = {name: look_at(tmp_path / name, NOW_S) for name in ("empty", "half", "whole", "garbage", "cut", "shards")}
    assert {name: look.state for name, look in looks.items()} == {
        "empty": "foreign",
        "half": "stopped",
        "whole": "complete",
        "garbage": "unreadable",
        "cut": "unreadable",
        "shards": "unreadable",
    }
    assert (looks["half"].done, looks["half"].trials, looks["whole"].done) == (2, 6, 6)
    assert looks["whole"].successes() == sum(row_of(job).strict for job in jobs)
    assert "is corrupt" in looks["garbage"].note and "--salvage" in looks["cut"].note
    assert "backend merge" in looks["shards"].note
    with store_in(tmp_path / "half", OF):
        assert look_at(tmp_path / "half", NOW_S).state == "running"


def test_a_second_look_sees_what_has_come_since(tmp_path: Path):
    jobs = all_jobs(OF)
    with store_in(tmp_path, OF) as store:
        before = look_at(tmp_path, NOW_S)
        assert before.done == 0
        for job in jobs[:4]:
            store.add(row_of(job))
            before = look_at(tmp_path, NOW_S, before)
            fresh = look_at(tmp_path, NOW_S)
            assert (before.cells, before.reasons, before.done) == (fresh.cells, fresh.reasons, fresh.done)
    assert before.done == 4
    assert look_at(tmp_path, NOW_S, before).cells is before.cells


def test_what_was_begun_is_gone_on_with_by_the_same_settings(tmp_path: Path):
    settings = GridSettings(
        robots=("mico",), methods=("ik",), trials=7, set=("sensing.dropout=0.1", "timing.budget_s=0.2")
    )
    of = make_plan(settings)
    for text in (grid_file_of(of), grid_file(facts_of(of, None))):
        (tmp_path / "grid.toml").write_text(text)
        again = settings_from(read_grid_file(tmp_path / "grid.toml"))
        assert again == settings and make_plan(again).decided() == of.decided()


def test_a_trial_set_cannot_be_begun_from_the_page():
    with pytest.raises(InvalidInputError, match="command line"):
        NewRun(name="x", trials_sha256="0" * 64).plan()


@pytest.mark.parametrize("robot", ["mico", "ur5_robotiq"])
def test_a_link_leads_to_the_very_scenario_of_the_row(robot: str):
    conditions = ("sensing.position_noise_std_m=0.002", "timing.timeout_s = 60.0")
    of = make_plan(GridSettings(robots=(robot,), methods=tuple(METHODS), trials=1, profile="datasheet", set=conditions))
    for job in all_jobs(of):
        restart = restart_of(of, row_of(job))
        assert scenario_of(restart).model_copy(update={"seed": job.seed}) == job.scenario
        assert restart.seed == job.seed
        link = link_to(of, row_of(job))
        assert link is not None
        assert trial_at(dict(parse_qsl(urlsplit(link).query))) == restart


@pytest.mark.parametrize(
    ("robot", "task", "method"), [("ur5_robotiq", "circular", "no_prediction"), ("mico", "linear", "ik")]
)
def test_the_replay_of_a_row_is_the_row_bit_for_bit(robot: str, task: str, method: str):
    of = make_plan(GridSettings(robots=(robot,), tasks=(task,), objects=("cube",), methods=(method,), trials=2))
    job = all_jobs(of)[1]
    row = run_job(job, "hash")
    restart = restart_of(of, row)
    left = _run_live(restart)
    assert left.record["fingerprint"] == row.fingerprint
    assert replay_of(restart, row, state_of(restart, left)) == "same"
    assert replay_of(restart, replace(row, fingerprint="0" * 16), state_of(restart, left)) == "different"


def state_of(restart: Restart, keepsake: Keepsake | None) -> SessionState:
    info = info_of(restart.scenario, scenario_of(restart))
    pace = Pace(True, 1.0, 0.0)
    return SessionState("running", info, restart, loading=False, pace=pace, events=restart.events, keepsake=keepsake)


def test_another_trial_on_the_page_says_nothing_of_the_row():
    row = row_of(all_jobs(OF)[0])
    restart = restart_of(OF, row)
    other = restart.model_copy(update={"seed": 99})
    assert replay_of(restart, row, state_of(other, None)) == "elsewhere"
    assert replay_of(restart, row, state_of(restart, None)) == "running"
    assert replay_of(restart, row, replace(state_of(restart, None), loading=True)) == "elsewhere"


def test_a_trial_that_the_page_cannot_begin_says_why():
    of = plan(first_seed=2**31)
    with pytest.raises(InvalidInputError, match="seeds up to"):
        restart_of(of, row_of(all_jobs(of)[0]))
    assert link_to(of, row_of(all_jobs(of)[0])) is None


def test_the_replay_of_a_trial_set_is_its_row_bit_for_bit():
    drawn, other = drawn_set(load_scenario("ur5_linear"), ["cube"], 2, 0)
    other = replace(other, seed=7)  # begins as seed 1 does
    of, jobs = _of_table(to_csv([drawn, other]))
    for job in jobs:
        row = run_job(job, "hash")
        link = link_to(of, row)
        assert link is not None
        restart = trial_at(dict(parse_qsl(urlsplit(link).query)))
        assert restart == restart_of(of, row) and scenario_of(restart) == job.scenario
        left = _run_live(restart)
        assert left.record["fingerprint"] == row.fingerprint


def _run_live(restart: Restart) -> Keepsake:
    episode = LiveEpisode(scenario_of(restart), restart.seed)
    try:
        for _ in episode.run():
            pass
        return episode.keepsake()
    finally:
        episode.close()


def _of_table(text: str):
    starts = starts_of(text, "test")
    table = {"robots": ["ur5_robotiq"], "tasks": ["linear"], "objects": ["cube"], "methods": ["ik"], "trials": 2}
    of = make_plan(settings_from({**table, "trials_sha256": sha256_of(text)}), starts)
    return of, all_jobs(of)


def test_a_run_of_a_trial_set_counts_its_rows(tmp_path: Path):
    text = to_csv(drawn_set(load_scenario("ur5_linear"), ["cube"], 2, 0))
    of, jobs = _of_table(text)
    with open_store(tmp_path / "grid.sqlite", facts_of(of, text)) as store:
        store.add(row_of(jobs[0]))
    look = look_at(tmp_path, NOW_S)
    assert (look.state, look.done, look.trials) == ("stopped", 1, 2)


def test_settings_are_those_of_the_rows_or_refused_with_the_difference(tmp_path: Path):
    runs = Runs(tmp_path)
    (tmp_path / "mine").mkdir()
    with store_in(tmp_path / "mine", OF) as store:
        store.add(row_of(all_jobs(OF)[0]))
        words = NewRun(name="mine", **OF.settings.model_dump())
        assert (runs.estimate(words).trials, runs.estimate(words).done) == (6, 1)
        with pytest.raises(GraspingError, match="Another grid is writing"):
            runs.start(words)
    more = runs.estimate(words.model_copy(update={"trials": 5}))
    assert (more.trials, more.done) == (10, 1)
    with pytest.raises(InvalidInputError, match="trials: 3 there, 2 asked for"):
        runs.estimate(words.model_copy(update={"trials": 2}))
    with pytest.raises(NotFoundError, match="runs no grid mine"):
        runs.process.stop("mine")
    assert runs.estimate(words.model_copy(update={"name": "new"})).done == 0
    assert not (tmp_path / "new").exists()
    runs.close()


def test_rows_are_those_of_a_grid_row():
    left_out = {"settings", "start"}
    assert set(Row.model_fields) == {field for field in GridRow.__dataclass_fields__} - left_out
