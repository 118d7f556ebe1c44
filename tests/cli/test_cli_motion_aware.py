"""``build motion-aware`` and ``report motion-aware`` from one end to the other, with a rule planted for physics."""

import json
from pathlib import Path

import pytest

from backend.build import motion_data
from backend.cli import build_motion_aware, main
from backend.cli.reports import motion_aware as report_motion_aware
from backend.knowledge import motion_aware
from tests.planted_rig import planted_source

PAIR = ["--robot", "mico", "--object", "cube"]


@pytest.fixture(autouse=True)
def planted(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    def model_file(robot: str, object: str) -> Path:
        return tmp_path / "models" / robot / f"{object}.npz"

    def source_of(database: object, seed: int) -> motion_data.Source:
        return planted_source(seed)

    monkeypatch.setattr(motion_data, "cache_folder", lambda: tmp_path / "cache")
    monkeypatch.setattr(motion_aware, "motion_aware_file", model_file)
    monkeypatch.setattr(build_motion_aware, "source_of", source_of)
    monkeypatch.setattr(report_motion_aware, "source_of", source_of)


def test_a_model_is_built_and_reported(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
):
    assert main(["report", "motion-aware", *PAIR]) == 2
    assert "build motion-aware --robot mico --object cube" in capsys.readouterr().err
    assert main(["build", "motion-aware", *PAIR, "--attempts", "500", "--workers", "1", "--json"]) == 0
    captured = capsys.readouterr()
    built = json.loads(captured.out)["models"][0]
    assert "500 of 500 attempts" in captured.err and Path(built["file"]).is_file()
    assert main(["build", "motion-aware", *PAIR, "--attempts", "500"]) == 0
    assert capsys.readouterr().err.splitlines()[-1] == "mico cube: up to date; --again makes it anew"

    figures = str(tmp_path / "figures")
    assert main(["report", "motion-aware", *PAIR, "--figures", figures, "--json"]) == 0
    table = json.loads(capsys.readouterr().out)["motion_aware"][0]
    assert (table["robot"], table["object"], table["attempts"]) == ("mico", "cube", 500)
    assert table["measured"]["trials"] == built["trials"]
    assert (tmp_path / "figures" / "motion_aware_mico.png").is_file()

    assert table["up_to_date"] is True

    def fewer_grasps(database: object, seed: int) -> motion_data.Source:
        return planted_source(seed, grasps=29)

    monkeypatch.setattr(report_motion_aware, "source_of", fewer_grasps)
    assert main(["report", "motion-aware", *PAIR]) == 0
    text = capsys.readouterr().out
    assert "code than are here now: cube" in text and "grasps never trained on" in text
    assert f"{built['trials']['accuracy']:.3f}" in text


def test_fresh_attempts_are_reported(capsys: pytest.CaptureFixture[str]):
    assert main(["build", "motion-aware", *PAIR, "--attempts", "300", "--workers", "1"]) == 0
    assert "mico cube: 300 attempts, accuracy" in capsys.readouterr().out
    assert main(["report", "motion-aware", *PAIR, "--attempts", "40", "--workers", "1"]) == 0
    text = capsys.readouterr().out
    assert "fresh attempts" in text and "4 cases" in text and "40 motions" in text
