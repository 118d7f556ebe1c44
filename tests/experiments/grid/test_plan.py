"""Which trials a grid has, and what is refused before any of them begins."""

import re
from collections import Counter
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from backend.errors import InvalidInputError, NotFoundError
from backend.experiments.grid.cells import Key, make_plan
from backend.experiments.grid.settings import GridSettings, differences, hash_of, read_grid_file, settings_from
from backend.methods import METHODS
from tests.experiments.grid.making import SMALL, all_jobs, key, plan


def test_the_papers_table_is_58800_trials_in_98_groups():
    whole = make_plan(GridSettings())
    assert whole.trials == 2 * 7 * 7 * 6 * 100 == 58_800
    assert len(whole.groups) == 98


def test_paired_trials_have_everything_in_common_but_the_method():
    for first, second in zip(all_jobs(plan())[::2], all_jobs(plan())[1::2], strict=True):
        assert (first.key.method, second.key.method) == ("ik", "baseline")
        assert first.key.index == second.key.index and first.seed == second.seed
        assert first.scenario.model_copy(update={"method": second.scenario.method}) == second.scenario


def test_a_scenario_is_that_of_its_robot_task_object_and_method():
    for job in all_jobs(plan(robots=("mico", "ur5_robotiq"), tasks=("circular", "linear_slab"), trials=1)):
        scenario = job.scenario
        assert (scenario.robot, scenario.task.kind, scenario.object) == (job.key.robot, job.key.task, job.key.object)
        assert scenario.method == METHODS[job.key.method]


@given(n=st.integers(1, 7))
def test_every_trial_is_in_exactly_one_shard_and_pairs_stay_together(n: int):
    whole = plan(trials=5, objects=("cube", "sugar_box"))
    shards = [[job.key for job in whole.jobs(lambda _: True, (i, n))] for i in range(1, n + 1)]
    assert Counter(key for shard in shards for key in shard) == Counter(job.key for job in all_jobs(whole))
    for shard in shards:
        pairs = Counter((k.object, k.index) for k in shard)
        assert set(pairs.values()) <= {2}


def test_what_has_a_row_is_not_run_again():
    done = {key(0), key(3, "baseline")}
    assert {job.key for job in plan().jobs(lambda k: k not in done)} == {job.key for job in all_jobs(plan())} - done


def test_conditions_reach_every_scenario():
    jobs = all_jobs(plan(set=("sensing.position_noise_std_m=0.002",), profile="datasheet", think="paper", first_seed=7))
    assert {job.scenario.sensing.position_noise_std_m for job in jobs} == {0.002}
    assert {(job.scenario.profile, job.scenario.timing.think) for job in jobs} == {("datasheet", "paper")}
    assert sorted({job.seed for job in jobs}) == [7, 8, 9, 10]


@pytest.mark.parametrize("override", ["robot=mico", "method=ik", "method.name=mine", "timing.think=measured", "seed=3"])
def test_what_the_grid_decides_is_not_a_condition(override: str):
    with pytest.raises(InvalidInputError, match=re.escape(override)):
        plan(set=(override,))


def test_what_is_set_of_a_method_is_set_of_all_and_leaves_their_differences():
    jobs = all_jobs(plan(set=("method.horizon.kind=step", "method.rehearsal=false"), methods=("ours_rm", "baseline")))
    assert {(job.scenario.method.horizon.kind, job.scenario.method.rehearsal) for job in jobs} == {("step", False)}
    assert {(job.key.method, job.scenario.method.filter.kind) for job in jobs} == {
        ("ours_rm", "reachability_motion"),
        ("baseline", "random"),
    }


def test_methods_that_a_setting_makes_the_same_are_named():
    with pytest.raises(InvalidInputError, match="no difference between the methods ours_rm and no_seeding"):
        plan(set=("method.planner.seeded=false",), methods=("ours_rm", "baseline", "no_seeding"))


def test_an_unknown_trial_is_answered_with_what_exists():
    with pytest.raises(NotFoundError, match=r"linear/cube/ik/4.*Indices: 0 to 3"):
        plan().job(key(4))
    with pytest.raises(NotFoundError, match="ik, baseline"):
        plan().job(key(0, "ours_rm"))


def test_keys_are_read_as_they_are_printed():
    assert Key.parse(str(key(17))) == key(17)
    for text in ("", "a/b/c/d", "a/b/c/d/-1", "a/b/c/d/e/1"):
        with pytest.raises(InvalidInputError, match="ROBOT/TASK/OBJECT/METHOD/INDEX"):
            Key.parse(text)


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ({"robots": ["ur6"]}, ["robots", "ur6", "ur5_robotiq"]),
        ({"tasks": ["linear", "linear"]}, ["tasks", "linear is listed 2 times"]),
        ({"objects": []}, ["objects", "at least one"]),
        ({"methods": ["best"]}, ["methods", "ours_rm"]),
        ({"trials": 0}, ["trials", "greater than or equal to 1", "0"]),
        ({"think": "measured"}, ["think", "measured", "budget"]),
        ({"trails": 3}, ["trails", "no such word", "trials"]),
    ],
)
def test_a_wrong_word_is_named_with_what_exists(table: dict[str, object], words: list[str]):
    with pytest.raises(InvalidInputError) as refusal:
        settings_from(table, "my.toml")
    for word in ["my.toml", *words]:
        assert word in str(refusal.value)


def test_a_grid_file_says_what_flags_say(tmp_path: Path):
    file = tmp_path / "grid.toml"
    file.write_text('robots = ["mico"]\ntrials = 3\nset = ["sensing.dropout=0.1"]\n')
    settings = settings_from(read_grid_file(file), str(file))
    assert settings == GridSettings(robots=("mico",), trials=3, set=("sensing.dropout=0.1",))
    file.write_text("robots = [")
    with pytest.raises(InvalidInputError, match="not valid TOML"):
        read_grid_file(file)
    with pytest.raises(InvalidInputError, match="cannot be read"):
        read_grid_file(tmp_path / "none.toml")


def test_the_judge_decides_no_row_and_everything_else_does():
    base = hash_of(make_plan(SMALL).decided())
    assert hash_of(plan(judge="authors").decided()) == base
    changes = ({"trials": 5}, {"profile": "datasheet"}, {"think": "paper"}, {"first_seed": 1}, {"methods": ("ik",)})
    assert len({base, *(hash_of(plan(**change).decided()) for change in changes)}) == 6


def test_differences_say_where_and_what():
    assert differences(plan().decided(), plan().decided()) == []
    assert differences(plan().decided(), plan(trials=9).decided()) == ["trials: 4 there, 9 asked for"]
    changed = plan().decided()
    changed["conditions"]["ur5_robotiq/linear/ik"]["task"]["speed_mps"] = 0.06
    line = "conditions.ur5_robotiq/linear/ik.task.speed_mps: 0.05 there, 0.06 asked for"
    assert differences(plan().decided(), changed) == [line]
