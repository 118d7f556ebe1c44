"""``bench``: every room has its times, and a trial takes longer than the steps that are in it."""

import json

import pytest

from backend.cli import main


def test_rooms_and_ratios_are_measured(capsys: pytest.CaptureFixture[str]):
    assert main(["bench", "--trials", "1", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert {"predict", "convert", "filter", "pick", "plan", "retime", "cycle"} <= found["rooms"].keys()
    assert all(0.0 < room["median_ms"] <= room["p95_ms"] for room in found["rooms"].values())
    assert 1.0 < found["trial_to_stepping"]
    assert found["bare_steps_per_s"] > 0.0 and found["trial_to_bare"] > 0.0
