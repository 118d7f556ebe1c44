"""``grid`` and what follows it, as their user would run them."""

import csv
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pyarrow.parquet
import pytest

from backend.cli import main
from backend.experiments.grid.folder import read_grid
from backend.experiments.grid.row import COLUMNS

QUICK = ["--set", "timing.timeout_s=0.5", "--tasks", "linear", "--objects", "cube", "--trials", "2"]
SMALL = ["--robots", "ur5_robotiq", "--methods", "ik", "baseline", "--workers", "1", *QUICK]
Capture = pytest.CaptureFixture[str]


def grid(out: Path, *arguments: str) -> int:
    return main(["grid", "--out", str(out), *arguments])


def refused(capsys: Capture, *arguments: str) -> str:
    assert main(arguments) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    return captured.err


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A grid of four short trials."""
    folder = tmp_path_factory.mktemp("grid") / "run"
    assert grid(folder, *SMALL) == 0
    return folder


def test_a_grid_is_run_once_and_paired(run: Path, capsys: Capture):
    with read_grid(run) as store:
        rows = {(row.index, row.method): row for row in store.rows()}
    assert sorted(rows) == [(0, "baseline"), (0, "ik"), (1, "baseline"), (1, "ik")]
    for i in (0, 1):
        assert rows[i, "ik"].start == rows[i, "baseline"].start
    assert rows[0, "ik"].start != rows[1, "ik"].start
    assert all(0.3 <= row.distance_m <= 0.7 and row.speed_mps == 0.05 for row in rows.values() if row.distance_m)
    assert grid(run, *SMALL) == 0
    assert "4 of 4 trials are there already" in capsys.readouterr().err
    with read_grid(run) as store:
        assert {(row.index, row.method): row for row in store.rows()} == rows


def test_the_same_grid_elsewhere_gives_the_same_rows(run: Path, tmp_path: Path):
    for i in (1, 2):
        assert grid(tmp_path, *SMALL, "--shard", f"{i}/2") == 0
    assert main(["merge", str(tmp_path)]) == 0
    with read_grid(run) as one, read_grid(tmp_path) as other:
        assert sorted(row.key for row in one.rows()) == sorted(row.key for row in other.rows())
        assert all(other.row(row.key).sure() == row.sure() for row in one.rows())


def test_a_dry_run_counts_and_writes_nothing(tmp_path: Path, capsys: Capture):
    out = tmp_path / "out"
    assert grid(out, "--dry-run") == 0
    assert capsys.readouterr().out.startswith("58800 trials, 0 of them done; the others take about")
    assert grid(out, *SMALL, "--shard", "1/2", "--dry-run", "--json") == 0
    assert json.loads(capsys.readouterr().out)["trials"] == 2
    assert not out.exists()


def test_a_trial_of_a_grid_is_replayed_bit_for_bit(run: Path, capsys: Capture):
    assert main(["replay", str(run), "ur5_robotiq/linear/cube/ik/1", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["same"] is True
    assert "no row of ur5_robotiq/linear/cube/ik/7" in refused(
        capsys, "replay", str(run), "ur5_robotiq/linear/cube/ik/7"
    )
    assert "Name its key" in refused(capsys, "replay", str(run))
    assert "ROBOT/TASK" in refused(capsys, "replay", str(run), "7")


def test_exported_tables_have_every_row_and_column(run: Path, tmp_path: Path):
    assert main(["export", str(run), "--to", str(tmp_path)]) == 0
    table = pyarrow.parquet.read_table(tmp_path / "trials.parquet")
    with read_grid(run) as store:
        rows = sorted((row.as_dict() for row in store.rows()), key=lambda row: (row["method"], row["index"]))
    assert table.column_names == list(COLUMNS) and table.to_pylist() == rows
    lines = list(csv.DictReader((tmp_path / "trials.csv").read_text().splitlines()))
    assert [line["fingerprint"] for line in lines] == [row["fingerprint"] for row in rows]


def test_a_trial_set_runs_the_trials_that_it_was_made_from(run: Path, tmp_path: Path, capsys: Capture):
    file = str(tmp_path / "set.csv")
    assert main(["trials", "export", file, "--task", "ur5_linear", "--objects", "cube", "--n", "2"]) == 0
    words = ["--trials-file", file, "--methods", "ik", "--set", "timing.timeout_s=0.5", "--workers", "1"]
    assert grid(tmp_path / "run", *words) == 0
    with read_grid(tmp_path / "run") as again, read_grid(run) as first:
        rows = list(again.rows())
        assert len(rows) == 2
        assert all(first.row(row.key).fingerprint == row.fingerprint for row in rows)
    assert main(["replay", str(tmp_path / "run"), str(rows[0].key)]) == 0
    capsys.readouterr()
    assert "trials and a trials file" in refused(capsys, "grid", "--out", str(tmp_path / "x"), *words, "--trials", "1")


def test_a_grid_file_is_overruled_by_flags(tmp_path: Path, capsys: Capture):
    file = tmp_path / "grid.toml"
    file.write_text(f'out = "{tmp_path}/run"\nrobots = ["mico"]\ntrials = 3\nmethods = ["ik"]\n')
    assert main(["grid", str(file), "--trials", "2", "--dry-run", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["trials"] == 2 * 7 * 7
    file.write_text('robts = ["mico"]\n')
    assert "robts: there is no such word" in refused(capsys, "grid", str(file), "--out", str(tmp_path))


def test_what_cannot_be_run_is_refused_before_anything_starts(tmp_path: Path, capsys: Capture):
    (tmp_path / "file").write_text("")
    bad = {
        "out is missing": ["grid", "--trials", "2"],
        "trials: input should be greater than or equal to 1 (got 0)": ["grid", "--out", str(tmp_path), "--trials", "0"],
        "no robot named 'ur6'": ["grid", "--out", str(tmp_path), "--robots", "ur6"],
        "Cannot write to the folder": ["grid", "--out", str(tmp_path / "file" / "x"), *SMALL],
        "workers: input should be greater": ["grid", "--out", str(tmp_path), "--workers", "0"],
        "--shard is i/n": ["grid", "--out", str(tmp_path), "--shard", "3/2"],
        "cannot be read": ["grid", "--out", str(tmp_path), "--trials-file", str(tmp_path / "none.csv")],
        "There is no folder": ["export", str(tmp_path / "none")],
        "--n must be at least 1": ["trials", "export", str(tmp_path / "x"), "--task", "ur5_linear", "--n", "0"],
        "no scenario named 'ur5'": ["trials", "export", str(tmp_path / "x"), "--task", "ur5"],
    }
    for words, arguments in bad.items():
        assert words in refused(capsys, *arguments)
    assert [path.name for path in tmp_path.iterdir()] == ["file"]


def test_more_workers_than_cores_are_warned_of(tmp_path: Path, capsys: Capture):
    assert grid(tmp_path, "--workers", str((os.cpu_count() or 1) + 1), "--dry-run") == 0
    assert "Warning" in capsys.readouterr().err


def test_ctrl_c_finishes_what_runs_and_says_how_to_go_on(tmp_path: Path):
    words = ["--out", str(tmp_path), "--robots", "ur5_robotiq", "--tasks", "linear", "--objects", "cube"]
    command = [sys.executable, "-m", "backend", "grid", *words, "--trials", "400", "--workers", "1"]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True, start_new_session=True) as process:
        deadline_s = time.monotonic() + 120.0
        while _rows(tmp_path) < 1 and time.monotonic() < deadline_s:
            time.sleep(0.2)
        os.killpg(process.pid, signal.SIGINT)
        _, errors = process.communicate(timeout=120)
    assert process.returncode == 1 and "Traceback" not in errors
    assert "Stopping" in errors and "The same command goes on from here" in errors
    with read_grid(tmp_path) as store:
        rows = list(store.rows())
    assert 1 <= len(rows) < 100 and all(row.reason != "error" for row in rows)


def _rows(folder: Path) -> int:
    if not (folder / "grid.sqlite").exists():
        return 0
    with read_grid(folder) as store:
        return len(store.keys())


def test_a_grid_is_reported(run: Path, tmp_path: Path, capsys: Capture):
    assert main(["report", str(run), "--to", str(tmp_path), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert [(cell["method"], cell["n"], cell["success"]["value"]) for cell in told["cells"]] == [
        ("ik", 2, 0.0),
        ("baseline", 2, 0.0),
    ]
    assert all(Path(file).is_file() for file in told["files"])
    assert "There is no report of 'graps'" in refused(capsys, "report", "graps")
    assert "python -m backend grid" in refused(capsys, "report", str(tmp_path))
