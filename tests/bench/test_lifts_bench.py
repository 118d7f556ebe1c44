"""The bench of lifts: every hand and object once, and the rate over all is that of the parts."""

import json

import pytest

from backend.cli import main
from backend.objects import OBJECTS
from backend.robots import ROBOTS


def test_every_hand_lifts_every_object(capsys: pytest.CaptureFixture[str]):
    assert main(["bench", "lifts", "--quick", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["lifts"]
    assert [(figure["part"], figure["what"]) for figure in found] == [
        (robot, what) for robot in ROBOTS for what in (*OBJECTS, "all")
    ]
    for robot in ROBOTS:
        *each, over_all = [figure for figure in found if figure["part"] == robot]
        assert over_all["measured"] == pytest.approx(len(each) / sum(1.0 / figure["measured"] for figure in each))
        assert over_all["of"] == sum(figure["of"] for figure in each)
        assert (over_all["target"], over_all["met"]) == (">= 30", over_all["measured"] >= 30.0)
