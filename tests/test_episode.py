"""The loop's laws: a seed is a trial, thinking costs the object's way, edits are repeated, ends have reasons."""

import json
from pathlib import Path

import numpy as np
import pytest

from backend.episode import Episode
from backend.errors import InvalidInputError, MissingResourceError
from backend.events import SetBeltRate
from backend.experiments.trial import run_trial
from backend.knowledge import motion_aware
from backend.knowledge.motion_aware import load_motion_aware
from backend.methods import METHODS
from backend.objects import load_object
from backend.pipeline.execute import Executor, approach
from backend.pipeline.rehearse import Rehearsal
from backend.pipeline.values import Phase, Refusal
from backend.record import load_trace
from backend.scenario import Scenario, load_scenario, with_overrides
from backend.sim.bullet import STEP_S
from backend.snapshot import Snapshot
from tests.measure_live import grasped
from tests.motion_models import plant_models

STRONGEST_FRICTION = 3.0
"""More than any two surfaces here have between them."""


def scenario(name: str, *overrides: str) -> Scenario:
    return with_overrides(load_scenario(name), overrides)


def first_ticks(setup: Scenario, seed: int, count: int) -> list[Snapshot]:
    with Episode(setup, seed) as episode:
        return [snapshot for snapshot, _ in zip(episode.run(), range(count), strict=False)]


def test_a_trial_grasps_and_says_how():
    seen: list[Snapshot] = []
    record = run_trial(scenario("ur5_linear"), seed=3, watch=seen.append)
    assert record.strict and record.authors and record.reason is None
    phases = list(dict.fromkeys(snapshot.phase for snapshot in seen))
    assert phases == ["watch", "move", "approach", "close", "lift", "hold", "done"]
    assert record.approach_start_s is not None and record.lift_end_s is not None
    assert 0 < record.approach_start_s < record.lift_end_s < record.end_s
    assert {snapshot.grip_n for snapshot in seen if snapshot.phase in ("watch", "move", "approach")} == {0.0}
    weight_n = 9.81 * load_object(record.object).mass_kg
    carried = [snapshot.grip_n for snapshot in seen if snapshot.phase == "hold"]
    assert min(carried) > weight_n / np.hypot(1.0, STRONGEST_FRICTION), "contacts that press less cannot carry it"
    last = seen[-1]
    assert last.outcome is not None and last.T_world_object.xyz_m[2] > seen[0].T_world_object.xyz_m[2] + 0.05


@pytest.mark.parametrize("name", ["mico_sinusoidal", "ur5_linear_obstacles"])
def test_the_same_seed_is_the_same_trial(name: str):
    """In one process; tests/test_parity.py has every scenario, in two."""
    setup = scenario(name, "object=cube", "timing.timeout_s=4.0")
    assert run_trial(setup, seed=1).fingerprint == run_trial(setup, seed=1).fingerprint


def test_another_seed_is_another_trial():
    setup = scenario("mico_linear", "timing.timeout_s=1.0")
    assert run_trial(setup, seed=1).fingerprint != run_trial(setup, seed=2).fingerprint


def test_trials_are_paired_over_methods(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    plant_models(monkeypatch, tmp_path)
    starts = [first_ticks(scenario("ur5_linear_obstacles", f"method={m}"), 5, 1)[0] for m in METHODS]
    for start in starts[1:]:
        np.testing.assert_array_equal(start.T_world_object.matrix, starts[0].T_world_object.matrix)
        np.testing.assert_array_equal(start.Ts_world_obstacle, starts[0].Ts_world_obstacle)


@pytest.mark.parametrize("name", ["ours_rm", "motion_aware", "no_seeding", "no_prediction"])
def test_methods_that_rank_by_motion_say_what_they_ranked_by(
    name: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
):
    plant_models(monkeypatch, tmp_path)
    last = first_ticks(scenario("ur5_linear", f"method={name}"), 3, 40)[-1]
    assert last.cycle is not None and last.cycle.shortlist is not None and last.cycle.prediction is not None
    short, motion = last.cycle.shortlist, last.cycle.prediction.motion(1, 2)
    assert short.motion_quality is not None and ((short.motion_quality > 0.0) & (short.motion_quality < 1.0)).all()
    assert (short.reachability_m is None) == (name == "motion_aware")
    if name != "no_prediction":
        assert motion.speed_mps == pytest.approx(0.05, rel=0.1)
    model = load_motion_aware("ur5_robotiq", "tomato_soup_can")
    told = model.over(short.candidates.Ts_object_grasp).about(motion.speed_mps, motion.direction_rad)
    np.testing.assert_array_equal(short.motion_quality, told)


def test_a_missing_motion_aware_model_names_file_and_command(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    def elsewhere(robot: str, object: str) -> Path:
        return tmp_path / f"{object}.npz"

    monkeypatch.setattr(motion_aware, "motion_aware_file", elsewhere)
    words = rf"{tmp_path}/cube\.npz is missing\. .* build motion-aware --robot mico --object cube"
    with pytest.raises(MissingResourceError, match=words):
        Episode(scenario("mico_linear", "method=ours_rm", "object=cube"), 0)


def test_slower_thought_lets_the_object_go_further_before_the_arm_reacts():
    def object_travel_until_the_arm_moves(think_s: float) -> float:
        setup = scenario("ur5_linear", f"timing.budget_s={think_s}")
        with Episode(setup, 3) as episode:
            start = None
            for snapshot in episode.run():
                start = start or snapshot
                if np.abs(snapshot.q - start.q).max() > 1e-3:
                    return float(np.linalg.norm(snapshot.T_world_object.xyz_m - start.T_world_object.xyz_m))
        raise AssertionError("the arm never moved")

    quick, slow = object_travel_until_the_arm_moves(0.1), object_travel_until_the_arm_moves(1.0)
    assert slow - quick == pytest.approx(0.05 * 0.9, abs=0.005)


def test_the_papers_charge_makes_about_two_cycles_a_second():
    ticks = first_ticks(scenario("ur5_linear", "timing.think=paper"), 3, 91)
    assert 5 <= ticks[-1].cycles <= 9


def test_measured_thought_still_grasps():
    assert run_trial(scenario("ur5_linear", "timing.think=measured", "timing.budget_s=0.3"), seed=3).strict


def _refuse(*_: object) -> Refusal:
    return Refusal("nothing passes")


def test_a_way_in_that_is_wrong_and_cannot_be_bent_is_given_up_for_another(monkeypatch: pytest.MonkeyPatch):
    """The belt turns round while the hand settles, and no correction passes: it must not close on nothing."""
    with Episode(scenario("ur5_linear"), 3) as episode:
        phases: list[Phase] = []
        with monkeypatch.context() as refusing:
            refusing.setattr(approach, "ALIGN_MPS", 0.01)  # so that it takes its time
            for snapshot in episode.run():
                phases.append(snapshot.phase)
                if snapshot.phase == "approach" and "approach" not in phases[:-1]:
                    episode.apply(SetBeltRate(rate=-1.0))
                    refusing.setattr(Rehearsal, "unsafe", _refuse)
                if phases[-2:] == ["approach", "move"]:
                    break
            speed_rps = np.abs(episode.world.qd()).max()
        assert speed_rps < 0.4
        outcome = None
        for snapshot in episode.run():
            phases.append(snapshot.phase)
            outcome = snapshot.outcome
    assert list(dict.fromkeys(phases))[:3] == ["watch", "move", "approach"]
    assert phases.count("close") > 0 and outcome is not None and outcome.strict


@pytest.mark.parametrize(("name", "seed"), [("ur5_linear", 4), ("ur5_linear", 6), ("mico_linear", 5)])
def test_a_belt_that_turns_round_as_the_hand_goes_in_does_not_save_the_object(name: str, seed: int):
    assert grasped(name, seed, rate=-1.0)


def test_a_grasp_that_cannot_be_gone_in_for_yet_is_not_dropped_on_the_way_to_it():
    """Else the arm turns from one grasp to the next until the belt has come to its end, as it once did here."""
    setup = scenario("ur5_linear_z", "method=ours_rm", "object=sugar_box")
    assert run_trial(setup, seed=11).strict


def test_the_arm_keeps_its_speed_limits():
    setup = scenario("ur5_linear_obstacles")
    with Episode(setup, 2) as episode:
        qs = np.array([snapshot.q for snapshot in episode.run()])
    limit = 0.315
    assert np.abs(np.diff(qs, axis=0) * 30.0).max() <= 1.01 * limit


def test_the_arm_never_hesitates_where_a_new_plan_takes_over(monkeypatch: pytest.MonkeyPatch):
    """What the arm is asked for at every physics step: positions and velocities agree, and neither jumps."""
    asked: list[tuple[list[float], list[float]]] = []
    targets = Executor.targets

    def noted(self: Executor, t_s: float) -> tuple[list[float], list[float]]:
        if self.phase == "move":
            asked.append(targets(self, t_s))
        return targets(self, t_s)

    monkeypatch.setattr(Executor, "targets", noted)
    with Episode(scenario("ur5_linear_obstacles"), 2) as episode:
        episode.finish()
        profile = episode.world.model.description.profiles["paper"]
    q, qd = (np.array(part) for part in zip(*asked, strict=True))
    assert len(q) > 500
    jumps = np.abs(np.diff(qd, axis=0)) - 1.02 * np.array(profile.acceleration_rps2) * STEP_S
    assert jumps.max() <= 1e-3
    np.testing.assert_allclose(np.diff(q, axis=0) / STEP_S, (qd[1:] + qd[:-1]) / 2, atol=5e-3)


@pytest.mark.parametrize(
    ("name", "object", "seed"),
    [("ur5_linear", "tomato_soup_can", 0), ("mico_linear_obstacles", "mustard_bottle", 4), ("ur5_linear", "cube", 1)],
)
def test_the_arm_leaves_the_object_standing_until_it_goes_in(name: str, object: str, seed: int):
    """The first two ran into the object on their way to where they would have met it later."""
    with Episode(scenario(name, "method=ours_rm", f"object={object}"), seed) as episode:
        snapshots = list(episode.run())
    on_tray = [s.T_world_tray.inverse() @ s.T_world_object for s in snapshots if s.phase in ("watch", "move")]
    assert len(on_tray) > 60
    places = np.array([T.xyz_m for T in on_tray])
    assert np.abs(places - places[0]).max() < 2e-3
    assert snapshots[-1].outcome is not None and snapshots[-1].outcome.strict


def test_a_live_edit_is_recorded_and_repeated(tmp_path: Path):
    setup = scenario("ur5_linear", "timing.timeout_s=6.0")
    with Episode(setup, 3) as episode:
        for snapshot in episode.run():
            if snapshot.tick == 45:
                episode.apply(SetBeltRate(rate=0.25))
        trace_file = tmp_path / "edited.npz"
        episode.recorder.save_trace(trace_file)
        live = episode.recorder.fingerprint()
    trace = load_trace(trace_file)
    assert [(timed.tick, timed.event) for timed in trace.scenario.events] == [(45, SetBeltRate(rate=0.25))]
    assert run_trial(trace.scenario).fingerprint == live
    assert run_trial(setup, seed=3).fingerprint != live


def test_what_is_not_a_trace_is_refused(tmp_path: Path):
    other = tmp_path / "other.npz"
    other.write_text("not a trace")
    with pytest.raises(InvalidInputError, match=r"other\.npz is not a trace .* --trace FILE"):
        load_trace(other)
    with pytest.raises(InvalidInputError, match="There is no trace file"):
        load_trace(tmp_path / "missing.npz")


def test_a_trace_that_cannot_be_written_says_so(tmp_path: Path):
    (tmp_path / "file").touch()
    with pytest.raises(InvalidInputError, match="Cannot write the trace"):
        run_trial(scenario("ur5_linear", "timing.timeout_s=0.5"), 1, tmp_path / "file" / "trial.npz")


@pytest.mark.parametrize(("method", "reason"), [("ik", "never_reachable"), ("ours_rm", "no_ik")])
def test_a_belt_out_of_reach_ends_with_its_reason(method: str, reason: str):
    """A ranking keeps the best of what there is, so that only the IK finds out."""
    belt = ("task.distance_min_m=1.9", "task.distance_max_m=2.0", "task.speed_mps=0.2")
    record = run_trial(scenario("mico_linear", f"method={method}", *belt), seed=0)
    assert not record.strict and record.reason == reason
    assert "belt came to its end" in record.detail


def test_time_is_up_when_the_scenario_says():
    record = run_trial(scenario("mico_linear", "timing.timeout_s=1.0"), seed=0)
    assert record.reason == "timeout" and record.end_s == pytest.approx(1.0, abs=0.01)


@pytest.mark.parametrize("method", METHODS)
def test_every_method_runs(method: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    plant_models(monkeypatch, tmp_path)
    ticks = first_ticks(scenario("ur5_linear_obstacles", f"method={method}"), 2, 90)
    assert ticks[-1].cycles > 10


def test_noise_latency_and_dropout_are_lived_through():
    rough = scenario(
        "ur5_linear",
        "sensing.position_noise_std_m=0.001",
        "sensing.latency_s=0.1",
        "sensing.dropout=0.3",
    )
    assert run_trial(rough, seed=3).strict


def test_a_record_is_one_json_object():
    record = run_trial(scenario("ur5_linear", "timing.timeout_s=0.5"), seed=1)
    row = json.loads(json.dumps(record.as_dict()))
    for key in ("robot", "task", "object", "method", "seed", "profile", "think", "fingerprint", "reason"):
        assert key in row
