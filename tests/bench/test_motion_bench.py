"""The bench of motion: its measures against plain oracles, and that all of it runs."""

import json
import math

import numpy as np
import pytest

from backend.bench.course import Course, run_course, scene_of, show
from backend.bench.figure import Figure
from backend.bench.motion import reversals
from backend.bench.seeding import hard_problems
from backend.bench.truth import Truth
from backend.cli import main
from backend.pose import Pose
from backend.scenario import load_scenario, with_overrides


@pytest.fixture(scope="module")
def course() -> Course:
    name = "ur5_linear_slab"
    return run_course(name, with_overrides(load_scenario(name), ["timing.timeout_s=2"]), 0)


def test_a_figure_meets_its_target_or_misses_it():
    assert Figure("a", "b", 5.0, sense="<=", target=5.0).met and Figure("a", "b", 5.0, sense=">=", target=5.0).met
    assert Figure("a", "b", 5.1, sense="<=", target=5.0).met is False
    assert Figure("a", "b", math.nan, sense=">=", target=5.0).met is False
    assert Figure("a", "b", 5.0).met is None
    assert "MISSED" in Figure("a", "b", 5.1, "ms", "<=", 5.0, 3).line()


def test_reversals_are_the_turns_of_a_wave():
    phase = np.linspace(0.0, 6.0 * np.pi, 600)
    still = np.zeros(600)
    assert reversals(np.column_stack([np.sin(phase), still, phase])) == 6
    assert reversals(np.column_stack([still, 1e-5 * np.sin(50.0 * phase)])) == 0


def test_a_course_is_what_its_trial_planned(course: Course):
    again = run_course(course.name, with_overrides(load_scenario(course.name), ["timing.timeout_s=2"]), 0)
    assert np.array_equal(course.qs, again.qs) and len(course.problems) == len(again.problems) > 10
    planned = [cycle.plan for cycle in course.cycles if cycle.plan is not None]
    starts = [problem.request.q_start for problem in course.problems]
    assert all(any(np.array_equal(plan.path.waypoints[0], q) for q in starts) for plan in planned)
    scene = scene_of(course)
    for problem in hard_problems(course, 4):
        request = show(scene, problem)
        assert scene.is_free(request.q_start)
        assert not any(scene.edge_free(request.q_start, goal) for goal in request.goals)


def test_the_truth_feels_what_it_touches(course: Course):
    q = course.qs[0]
    with Truth(course) as truth:
        assert truth.clearance_m(q, 0.03) == 0.03 and truth.self_clearance_m(q) == 0.0
        tcp = truth.kinematics.fk(q)
        truth.move_target(Pose.of(tuple(tcp[:3, 3] - 0.1 * tcp[:3, 2])))
        assert truth.clearance_m(q, 0.03) < -0.001
        low = q.copy()
        low[1] = 0.5
        assert truth.clearance_m(low, 0.03) < 0.0


@pytest.mark.timeout(400)
def test_all_of_it_runs(capsys: pytest.CaptureFixture[str]):
    assert main(["bench", "motion", "--quick", "--json"]) == 0
    table = json.loads(capsys.readouterr().out)
    parts = {figure["part"] for figure in table["motion"]}
    assert table["machine"] and table["quick"]
    assert parts == {"cycle", "seeding", "success", "retiming", "limits", "inverse kinematics", "truth", "waviness"}
    for figure in table["motion"]:
        if figure["part"] in ("limits", "retiming", "inverse kinematics") and figure["unit"] != "us":
            assert figure["met"] in (True, None), figure
