"""What rows add up to, against figures worked out by hand and by other libraries."""

import csv
import itertools
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import binomtest, t, ttest_1samp

from backend.errors import InvalidInputError
from backend.experiments.grid.row import GridRow
from backend.experiments.grid.settings import PAPERS_METHODS
from backend.experiments.report.analysis import Rows, distance_bin_m, speed_bin_mps
from backend.experiments.report.document import report_of
from backend.experiments.report.pairs import comparisons, odd_pairs
from backend.experiments.report.paper import PAPERS_TASKS, papers_cell
from backend.experiments.report.statistics import bootstrapped_mean, compare, holm, p_of_no_difference, rate
from backend.experiments.report.table import Table
from tests.experiments.grid.making import all_jobs, plan, row_of

MEANS = {
    "mico": (0.833, 0.818, 0.773, 0.527, 0.795, 0.701),
    "ur5_robotiq": (0.872, 0.849, 0.787, 0.690, 0.834, 0.360),
}
"""Over the seven tasks, in the order of the table's methods."""


@pytest.mark.parametrize("robot", MEANS)
def test_the_papers_cells_have_the_papers_means(robot: str):
    for method, mean in zip(PAPERS_METHODS, MEANS[robot], strict=True):
        cells = [papers_cell(robot, task, method) for task in PAPERS_TASKS]
        assert np.mean([cell.success for cell in cells if cell is not None]) == pytest.approx(mean, abs=0.0006)
        assert all(cell is not None and 7.0 < cell.time_s < 40.0 for cell in cells)
    assert papers_cell(robot, "linear", "ik") is None and papers_cell("panda", "linear", "ours_rm") is None


@given(n=st.integers(1, 1000), share=st.floats(0.0, 1.0))
def test_wilsons_interval_is_scipys(n: int, share: float):
    k = round(share * n)
    interval, other = rate(k, n), binomtest(k, n).proportion_ci(method="wilson")
    assert (interval.low, interval.high) == pytest.approx((other.low, other.high), abs=1e-9)
    assert interval.value == k / n


@given(st.lists(st.tuples(st.booleans(), st.booleans()), min_size=1, max_size=60))
def test_mcnemars_test_is_a_binomial_test_of_the_trials_that_differ(pairs: list[tuple[bool, bool]]):
    first, second = np.array(pairs).T
    found = compare(first, second)
    b, c = sum(x and not y for x, y in pairs), sum(y and not x for x, y in pairs)
    assert (found.only_first, found.only_second, found.n) == (b, c, len(pairs))
    assert found.p == pytest.approx(1.0 if b + c == 0 else binomtest(b, b + c).pvalue)
    assert found.difference == pytest.approx(np.mean(first) - np.mean(second))


@settings(max_examples=20)
@given(st.lists(st.floats(0.0, 1.0), max_size=20))
def test_holms_correction_is_its_definition(p: list[float]):
    order = sorted(range(len(p)), key=lambda i: p[i])
    expected, largest = [0.0] * len(p), 0.0
    for rank, i in enumerate(order):
        largest = max(largest, min(1.0, (len(p) - rank) * p[i]))
        expected[i] = largest
    assert holm(p) == pytest.approx(expected)


def test_the_bootstrap_agrees_with_students_interval_where_that_is_right():
    values = np.random.default_rng(1).normal(2.0, 3.0, 400)
    interval = bootstrapped_mean(values)
    half = float(t.ppf(0.975, 399) * values.std(ddof=1) / 20.0)
    assert interval is not None and interval.value == pytest.approx(values.mean())
    assert interval.low == pytest.approx(values.mean() - half, abs=0.05)
    assert interval.high == pytest.approx(values.mean() + half, abs=0.05)
    assert interval == bootstrapped_mean(values)
    assert bootstrapped_mean(np.array([1.0])) is None


def rows_of(successes: dict[str, list[bool]], **changes: object) -> list[GridRow]:
    """Rows of methods whose trials succeed as listed; the i-th trial takes i seconds to the approach."""
    of = plan(methods=tuple(successes), trials=len(next(iter(successes.values()))))
    rows: list[GridRow] = []
    for job in all_jobs(of):
        hit = successes[job.key.method][job.key.index]
        start = float(job.key.index) if hit else None
        row = replace(row_of(job), strict=hit, authors=not hit, reason=None if hit else "dropped", start="same")
        rows.append(replace(row, approach_start_s=start, end_s=20.0, lift_end_s=start and start + 2.0, **changes))
    return rows


def test_a_cell_counts_and_averages_its_trials():
    (cell,) = Rows(rows_of({"ours_rm": [True, True, False, True]}), "strict").cells()
    assert (cell.n, cell.success.value) == (4, 0.75)
    assert cell.time_s is not None and cell.time_s.value == pytest.approx((0 + 1 + 20 + 3) / 4)
    assert cell.succeeded_s == pytest.approx(4 / 3)
    assert cell.success_gain == pytest.approx(0.75 - 0.874)
    assert cell.time_gain_s == pytest.approx(6.0 - 8.134)


def test_the_other_judge_counts_otherwise():
    rows = rows_of({"ours_rm": [True, True, False, True]})
    assert Rows(rows, "authors").cells()[0].success.value == 0.25


def test_an_error_is_a_failure_and_has_no_time():
    rows = rows_of({"ours_rm": [True, True, True]})
    rows[1] = replace(rows[1], strict=False, reason="error", approach_start_s=None, end_s=None)
    (cell,) = Rows(rows, "strict").cells()
    assert cell.success.value == pytest.approx(2 / 3)
    assert cell.time_s is not None and cell.time_s.value == pytest.approx((0 + 2) / 2)


def test_the_permutation_test_of_few_differences_counts_all_signs():
    differences = np.array([0.4, -0.1, 0.7, 0.3, 0.2, 0.9])
    signed = np.array(list(itertools.product((1.0, -1.0), repeat=6))) * differences
    as_far = np.abs(signed.mean(axis=1)) >= differences.mean() - 1e-12
    assert p_of_no_difference(differences) == pytest.approx(as_far.mean())
    assert p_of_no_difference(np.zeros(5)) == p_of_no_difference(np.array([3.0])) == 1.0


def test_the_permutation_test_of_many_differences_agrees_with_students():
    differences = np.random.default_rng(1).normal(0.15, 1.0, 300)
    students: Any = ttest_1samp(differences, 0.0)
    assert p_of_no_difference(differences) == pytest.approx(float(students.pvalue), abs=0.005)
    assert p_of_no_difference(differences + 0.3) < 1e-3


def test_methods_are_equally_good_but_not_equally_quick():
    rows = rows_of({"ours_rm": [True] * 12, "baseline": [True] * 12})
    rows = [
        replace(row, approach_start_s=(row.approach_start_s or 0.0) + 2.0 * (row.method == "baseline")) for row in rows
    ]
    over_all = comparisons(Rows(rows, "strict"), "ours_rm")[0]
    assert over_all.time_s.p_holm == pytest.approx(2 * 0.5**12)
    assert over_all.verdict == "ours_rm goes in sooner"
    assert comparisons(Rows(rows[:8] + rows[12:20], "strict"), "ours_rm")[0].verdict == "ours_rm goes in sooner"
    few = comparisons(Rows(rows[:3] + rows[12:15], "strict"), "ours_rm")[0]
    assert few.verdict == "no significant difference"


def test_methods_are_equally_good_but_one_takes_the_shorter_way():
    rows = rows_of({"ours_rm": [True] * 12, "no_seeding": [True] * 12})
    ways_rad = {"ours_rm": 3.0, "no_seeding": 3.5}
    rows = [replace(row, joint_path_rad=ways_rad[row.method]) for row in rows]
    over_all = comparisons(Rows(rows, "strict"), "ours_rm")[0]
    assert over_all.way_rad.mean is not None and over_all.way_rad.mean.value == pytest.approx(-0.5)
    assert over_all.way_rad.p_holm == pytest.approx(2 * 0.5**12)
    assert over_all.verdict == "ours_rm takes a shorter way"
    unmoved = [replace(row, joint_path_rad=None) for row in rows]
    assert comparisons(Rows(unmoved, "strict"), "ours_rm")[0].way_rad.mean is None


def test_methods_are_compared_on_the_same_trials_only():
    rows = rows_of({"ours_rm": [True] * 12, "baseline": [False] * 11 + [True]})
    over_all, single = comparisons(Rows([row for row in rows if row.key != rows[1].key], "strict"), "ours_rm")
    assert (over_all.task, single.task) == (None, "linear")
    assert (over_all.successes.n, over_all.successes.only_first, over_all.successes.only_second) == (11, 10, 0)
    assert over_all.p_holm == pytest.approx(2 * 0.5**10)
    assert over_all.verdict == "ours_rm grasps more often and goes in sooner"
    assert over_all.time_s.mean is not None and over_all.time_s.mean.value < 0.0 and over_all.both_s is None


def test_pairs_that_began_differently_are_counted():
    rows = rows_of({"ik": [True, True], "baseline": [True, True]})
    assert odd_pairs(Rows(rows, "strict")) == 0
    assert odd_pairs(Rows([replace(rows[0], start="other"), *rows[1:]], "strict")) == 1


def test_bins_hold_what_lies_in_them():
    row = rows_of({"ik": [True]})[0]
    for distance_m in (0.3, 0.3249, 0.34999):
        assert distance_bin_m(replace(row, distance_m=distance_m)) == pytest.approx(0.325)
    assert speed_bin_mps(replace(row, speed_mps=0.02)) == pytest.approx(0.02)
    assert distance_bin_m(row) is None and speed_bin_mps(row) is None


def test_a_table_says_the_same_in_every_format():
    table = Table("t", "A & B", ["x", "y_z"], [["1 | 2", "50 %\nsecond"], ["<b>", "#"]], "why")
    assert "| 1 \\| 2 | 50 %<br>second |" in table.markdown()
    assert "<td>50 %<br>second</td>" in table.html() and "&lt;b&gt;" in table.html()
    assert r"1 | 2 & \makecell{50 \% \\ second} \\" in table.latex() and r"y\_z" in table.latex()
    assert list(csv.reader(table.csv().splitlines())) == [["x", "y_z"], ["1 | 2", "50 %; second"], ["<b>", "#"]]


def test_a_report_is_whole_and_opens_offline(tmp_path: Path):
    of = plan(methods=("ours_rm", "baseline"), trials=6)
    rows = rows_of({"ours_rm": [True] * 6, "baseline": [True, False] * 3}, distance_m=0.41, speed_mps=0.05)
    rows = [replace(row, cycle_mean_ms=5.0, cycle_p95_ms=8.0, joint_path_rad=2.0, cycles=9) for row in rows]
    files = {file.name: file.read_text() for file in report_of(rows, of, "strict").write(tmp_path)}
    assert {"report.html", "report.md", "table.tex", "cells.csv", "pairs.csv", "reasons.csv"} <= files.keys()
    page = files["report.html"]
    assert "Plotly.newPlot" in page and not re.search(r"<(script|link|img)[^>]*(src|href)=", page)
    for text in (page, files["report.md"], files["table.tex"]):
        assert "1.000 (0.610-1.000)" in text and "0.500" in text
    assert "12 of 12 trials" in files["report.md"]
    with pytest.raises(InvalidInputError, match="no rows yet"):
        report_of([], of, "strict")


def test_a_grid_without_linear_belts_has_a_report_without_their_distances(tmp_path: Path):
    of = plan(methods=("ours_rm",), trials=2)
    rows = [replace(row, task="circular", speed_mps=0.05) for row in rows_of({"ours_rm": [True] * 2})]
    names = {file.name for file in report_of(rows, of, "strict").write(tmp_path)}
    assert "by_speed.csv" in names and "by_distance.csv" not in names
