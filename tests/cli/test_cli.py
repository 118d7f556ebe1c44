"""The command line: what it prints, what it refuses and how, as its user would run it."""

import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from backend.cli import main
from backend.methods import METHODS
from backend.objects import OBJECTS
from backend.robots import ROBOTS
from backend.scenario import scenario_names

QUICK = ["--set", "timing.timeout_s=0.5"]


def refused(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    assert main(arguments) == 2
    captured = capsys.readouterr()
    assert captured.out == ""
    return captured.err


def test_json_is_one_object_on_stdout_and_nothing_else():
    command = [sys.executable, "-m", "backend", "trial", "ur5_linear", "--seed", "1", "--json", *QUICK]
    answer = subprocess.run(command, capture_output=True, text=True, check=False)
    row = json.loads(answer.stdout)
    assert row["seed"] == 1 and row["reason"] == "timeout" and row["strict"] is False
    assert answer.returncode == 1


@pytest.mark.parametrize(("timed", "last"), [([], "of those that lifted"), (["--lifts", "4"], "lifts/s")])
def test_grasps_are_reported_with_lifts_a_second_where_asked(
    capsys: pytest.CaptureFixture[str], timed: list[str], last: str
):
    assert main(["report", "grasps", "--robot", "mico", "--object", "cube", *timed]) == 0
    head, rule, row = (line.strip("| ").split("|") for line in capsys.readouterr().out.splitlines())
    assert head[-1].strip() == last and len(head) == len(rule) == len(row)
    assert [cell.strip() for cell in row[:2]] == ["mico cube", "100"]
    assert float(row[2]) > 0.95 and all(cell.strip() for cell in row)


def test_a_trial_is_described_for_people(capsys: pytest.CaptureFixture[str]):
    assert main(["trial", "mico_linear", *QUICK]) == 1
    text = capsys.readouterr().out
    assert "failed: timeout" in text and "fingerprint" in text


def test_a_value_is_changed_by_its_path(capsys: pytest.CaptureFixture[str]):
    main(["trial", "ur5_linear", "--json", *QUICK])
    slow = json.loads(capsys.readouterr().out)
    main(["trial", "ur5_linear", "--json", *QUICK, "--set", "task.speed_mps=0.08"])
    assert json.loads(capsys.readouterr().out)["fingerprint"] != slow["fingerprint"]


def test_a_traced_trial_is_replayed_bit_for_bit(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    trace = str(tmp_path / "trial.npz")
    main(["trial", "ur5_linear_obstacles", "--seed", "2", "--trace", trace, *QUICK])
    capsys.readouterr()
    assert main(["replay", trace, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["same"] is True


def test_info_lists_everything(capsys: pytest.CaptureFixture[str]):
    assert main(["info", "--json"]) == 0
    table = json.loads(capsys.readouterr().out)
    assert table["robots"] == list(ROBOTS) and table["objects"] == list(OBJECTS)
    assert table["methods"] == list(METHODS) and table["scenarios"] == list(scenario_names())
    assert len(table["tasks"]) == 7 and "pybullet" in table["versions"]
    assert main(["info"]) == 0
    assert "tomato_soup_can" in capsys.readouterr().out


def test_warming_up_names_every_robot_and_the_planners(capsys: pytest.CaptureFixture[str]):
    assert main(["warm", "--json"]) == 0
    assert list(json.loads(capsys.readouterr().out)["took_s"]) == [*ROBOTS, "planners"]


def test_a_survey_counts_every_trial(capsys: pytest.CaptureFixture[str], tmp_path: Path):
    rows = tmp_path / "rows.jsonl"
    selection = "--scenarios ur5_linear --objects cube --seeds 2 --workers 1".split()
    code = main(["survey", *selection, "--json", "--out", str(rows), *QUICK])
    assert code == 0
    tables = json.loads(capsys.readouterr().out)
    assert tables["by robot"][0]["n"] == 2 and tables["by robot"][0]["reasons"] == {"timeout": 2}
    assert [json.loads(line)["seed"] for line in rows.read_text().splitlines()] == [0, 1]


def test_an_unknown_scenario_lists_what_exists(capsys: pytest.CaptureFixture[str]):
    text = refused(capsys, "trial", "ur5_liner")
    assert "no scenario named 'ur5_liner'" in text and "mico_linear" in text and "'ur5_linear'" in text


@pytest.mark.parametrize(
    ("override", "words"),
    [
        ("object=teapot", ["teapot", "tomato_soup_can"]),
        ("robot=ur6", ["ur6", "ur5_robotiq"]),
        ("method=best", ["best", "baseline"]),
        ("task.sped=0.1", ["sped", "speed_mps"]),
        ("task.speed_mps=nan", ["task.linear.speed_mps", "nan"]),
        ("task.speed_mps=inf", ["task.linear.speed_mps", "inf"]),
        ("task.speed_mps=-1", ["task.linear.speed_mps", "greater than 0"]),
        ("timing.budget_s=fast", ["timing.budget_s", "fast"]),
        ("nonsense", ["nonsense", "="]),
    ],
)
def test_bad_values_are_refused_by_name(capsys: pytest.CaptureFixture[str], override: str, words: list[str]):
    text = refused(capsys, "trial", "ur5_linear", "--set", override)
    for word in words:
        assert word in text, text


def test_bad_counts_are_refused(capsys: pytest.CaptureFixture[str]):
    assert "--seeds must be at least 1" in refused(capsys, "survey", "--seeds", "0")
    assert "--trials must be at least 1" in refused(capsys, "bench", "--trials", "0")
    assert "--workers must be at least 1" in refused(capsys, "survey", "--workers", "0")
    assert "--seed must not be negative" in refused(capsys, "trial", "ur5_linear", "--seed", "-1")
    assert "--poses must be at least 100" in refused(capsys, "report", "reachability", "--poses", "9")
    assert "--workers must be at least 1" in refused(capsys, "build", "reachability", "--workers", "0")
    assert "no robot named 'ur6'" in refused(capsys, "build", "reachability", "--robot", "ur6")
    for what in ("build", "report"):
        assert "--workers must be at least 1" in refused(capsys, what, "motion-aware", "--workers", "0")
        assert "no object named 'cub'" in refused(capsys, what, "motion-aware", "--object", "cub")
    assert "--attempts must be at least 100" in refused(capsys, "build", "motion-aware", "--attempts", "99")
    assert "--attempts must not be negative" in refused(capsys, "report", "motion-aware", "--attempts", "-1")


def test_what_is_up_to_date_is_not_made_again(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch):
    asked: list[int] = []

    def is_up_to_date(found: object, seed: int, *_: object) -> bool:
        asked.append(seed)
        return True

    for module in ("grasps", "reach_finish", "predictor"):
        monkeypatch.setattr(f"backend.build.{module}.is_up_to_date", is_up_to_date)
    assert main(["build", "grasps", "--robot", "mico", "--object", "cube", "--seed", "5"]) == 0
    assert main(["build", "reachability", "--robot", "mico", "--seed", "6"]) == 0
    assert main(["build", "predictor", "--seed", "7"]) == 0
    assert asked == [5, 6, 7]
    assert capsys.readouterr().err.count("up to date; --again makes it anew") == 3


def test_a_field_is_not_begun_without_the_databases_that_it_is_checked_on(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr("backend.knowledge.pairs.ASSETS", Path("nowhere"))
    text = refused(capsys, "build", "reachability", "--robot", "mico", "--again")
    assert "python -m backend build grasps --robot mico --object bleach_cleanser" in text


def test_ctrl_c_ends_cleanly_and_leaves_no_file(tmp_path: Path):
    trace = tmp_path / "trial.npz"
    out_of_reach = ["task.distance_min_m=1.9", "task.distance_max_m=2.0", "task.speed_mps=0.005"]
    settings = [word for value in out_of_reach for word in ("--set", value)]
    arguments = ["backend", "trial", "mico_linear", "--trace", str(trace), *settings]
    code = "import signal, runpy, sys; signal.signal(signal.SIGINT, signal.default_int_handler); " + (
        f"sys.argv = {arguments!r}; runpy.run_module('backend', run_name='__main__')"
    )
    process = subprocess.Popen([sys.executable, "-c", code], stderr=subprocess.PIPE, text=True)
    time.sleep(2.5)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 130, errors
    assert "interrupted" in errors and "Traceback" not in errors
    assert list(tmp_path.iterdir()) == []
