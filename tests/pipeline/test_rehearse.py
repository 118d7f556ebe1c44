"""Rehearsals: a way in that passes arrives where it should, and what is in its way is named."""

import re
from dataclasses import replace

import numpy as np
import pytest

from backend.kinematics import load_kinematics
from backend.knowledge.grasps import load_grasps
from backend.methods.method import IkFilter
from backend.objects import load_object
from backend.pipeline.convert import convert
from backend.pipeline.execute import Approach, ApproachRequest, ArmState, plan_approach
from backend.pipeline.filter import shortlist
from backend.pipeline.pick import pick_nearest
from backend.pipeline.rehearse import MOST_AT_ONCE, Rehearsal
from backend.pipeline.retime import JointLimits
from backend.pipeline.values import Candidate, JointGoal, Refusal
from backend.pose import Array, Pose
from backend.sim.planning_scene import PlanningScene
from backend.trajectory import Trajectory
from tests.pipeline.contexts import context_of

BACKOFF_M = 0.075
SPEED_MPS = np.array([0.0, 0.03, 0.0])
START = Pose.from_xyz_yaw((0.5, 0.0, 0.02), 0.4)
KINEMATICS = load_kinematics("ur5_robotiq")


def object_at(t_s: Array) -> Array:
    Ts = np.repeat(START.matrix[None], len(t_s), axis=0)
    Ts[:, :3, 3] += t_s[:, None] * SPEED_MPS
    return Ts


def request(candidate: Candidate, goal: JointGoal) -> ApproachRequest:
    arm = ArmState(goal.q_pregrasp, np.zeros(6), 0.0)
    return ApproachRequest(arm, object_at, candidate.T_object_grasp, BACKOFF_M, slide_s=1.0, ride_s=1.0)


def rehearsal(scene: PlanningScene, fastest_rps: float = 1.0, strongest_rps2: float = 10.0) -> Rehearsal:
    limits = JointLimits(np.full(6, fastest_rps), np.full(6, strongest_rps2))
    return Rehearsal(KINEMATICS, scene, limits, lift_m=0.1)


def standing_on_the_belt() -> PlanningScene:
    scene = PlanningScene(KINEMATICS)
    scene.set_target(load_object("cube"), START, (0.1, 0.1, 0.02), START)
    return scene


@pytest.fixture(scope="module")
def picked() -> tuple[Candidate, ...]:
    candidates = convert(load_grasps("ur5_robotiq", "cube"), START, BACKOFF_M)
    context = context_of(None, frozenset())
    found, _ = pick_nearest(shortlist(IkFilter(), candidates, context), context)
    assert len(found) > 2
    return found


def test_a_way_in_ends_on_the_moving_object(picked: tuple[Candidate, ...]):
    answers = [rehearsal(standing_on_the_belt()).approach(request(c, c.goals[0])) for c in picked]
    passed = [(c, a) for c, a in zip(picked, answers, strict=True) if isinstance(a, Approach)]
    assert passed
    for candidate, approach in passed:
        q, _ = approach.trajectory.sample(approach.arrive_s)
        grasp = object_at(np.array([approach.arrive_s]))[0] @ candidate.T_object_grasp.matrix
        np.testing.assert_allclose(KINEMATICS.fk(q), grasp, atol=2e-3)


def test_a_way_in_keeps_to_the_limits_and_takes_longer_for_it(picked: tuple[Candidate, ...]):
    def way_in(strongest_rps2: float) -> Approach | Refusal:
        return rehearsal(standing_on_the_belt(), 0.35, strongest_rps2).approach(asked)

    compared = 0
    for candidate in picked:
        asked = request(candidate, candidate.goals[0])
        strong, weak = way_in(10.0), way_in(0.2)
        if isinstance(strong, Refusal) or isinstance(weak, Refusal):
            continue
        compared += 1
        for approach, strongest_rps2 in ((strong, 10.0), (weak, 0.2)):
            velocity, acceleration = approach.trajectory.peaks()
            assert velocity.max() <= 0.35 * 1.001 and acceleration.max() <= strongest_rps2 * 1.001
        assert weak.arrive_s > strong.arrive_s
    assert compared


@pytest.mark.parametrize("spin_rps", [0.0, 0.3])
def test_a_way_in_goes_on_as_the_arm_moves_whichever_way_the_hand_is_turned(
    picked: tuple[Candidate, ...], spin_rps: float
):
    """However the hand still turns against a grasp that moves and turns itself, no joint starts with a jerk."""

    def turning(t_s: Array) -> Array:
        Ts = object_at(t_s)
        Ts[:, :3, :3] = Ts[:, :3, :3] @ np.array([Pose.from_xyz_yaw((0, 0, 0), spin_rps * t).rotation for t in t_s])
        return Ts

    began = 0
    rng = np.random.default_rng(3)
    for candidate in picked:
        q = candidate.goals[0].q_pregrasp + rng.uniform(-0.1, 0.1, 6)
        arm = ArmState(q, rng.uniform(-0.4, 0.4, 6), 0.0)
        asked = ApproachRequest(arm, turning, candidate.T_object_grasp, BACKOFF_M, slide_s=1.0, ride_s=0.5)
        way_in = plan_approach(KINEMATICS, JointLimits(np.full(6, 10.0), np.full(6, 1000.0)), asked)
        if isinstance(way_in, Refusal):
            continue
        began += 1
        _, first = way_in.trajectory.peaks(until_s=0.02)
        _, later = way_in.trajectory.peaks(from_s=0.05, until_s=0.15)
        assert (first <= 1.5 * later.max() + 0.5).all(), (first, later)
    assert began > 2


def test_the_hand_slides_in_when_it_was_to_however_often_the_prediction_changes(picked: tuple[Candidate, ...]):
    """As long as the arm can: an approach planned anew with every observation must not put the slide off for ever."""
    limits = JointLimits(np.full(6, 0.35), np.full(6, 2.0))
    asked = request(picked[0], picked[0].goals[0])
    first = approach = plan_approach(KINEMATICS, limits, replace(asked, slide_from_s=1.0))
    assert isinstance(first, Approach) and isinstance(approach, Approach)
    rng = np.random.default_rng(0)
    corrections = 0
    t_s = 0.05
    while t_s < approach.slide_s:
        shift = rng.normal(0.0, 2e-3, 3)

        def shifted(times_s: Array, shift: Array = shift) -> Array:
            Ts = object_at(times_s)
            Ts[:, :3, 3] += shift
            return Ts

        arm = ArmState(*approach.trajectory.sample(t_s), t_s)
        answer = plan_approach(KINEMATICS, limits, replace(asked, arm=arm, object_at=shifted).instead_of(approach))
        if isinstance(answer, Approach):
            approach = answer
            corrections += 1
        t_s += 0.05
    assert corrections >= 10
    assert approach.slide_s == pytest.approx(first.slide_s, abs=0.15)
    assert approach.arrive_s == pytest.approx(first.arrive_s, abs=0.4)


def test_an_obstacle_in_the_way_is_named(picked: tuple[Candidate, ...]):
    scene = standing_on_the_belt()
    scene.add_object(load_object("sugar_box"), START)
    answer = rehearsal(scene).approach(request(picked[0], picked[0].goals[0]))
    assert isinstance(answer, Refusal)
    assert answer.why.startswith("approach: ") and "sugar_box" in answer.why


def test_what_is_above_the_hand_is_in_the_way_of_the_lift_first(picked: tuple[Candidate, ...]):
    def answer(above_m: float) -> Approach | Refusal:
        scene = standing_on_the_belt()
        scene.add_box((0.04, 0.04, 0.04), Pose.of((*where[:2], where[2] + above_m)))
        return rehearsal(scene).approach(request(from_above, from_above.goals[0]))

    from_above = min(picked, key=lambda candidate: candidate.T_world_grasp.rotation[2, 2])
    arrived = rehearsal(standing_on_the_belt()).approach(request(from_above, from_above.goals[0]))
    assert isinstance(arrived, Approach)
    where = KINEMATICS.fk(arrived.trajectory.sample(arrived.arrive_s + 0.5)[0])[:3, 3]
    answers = [answer(above_m) for above_m in np.arange(0.9, 0.0, -0.02)]
    assert isinstance(answers[0], Approach)
    first = next(answer for answer in answers if isinstance(answer, Refusal))
    assert re.fullmatch(r"lift: \S+ too near to the slab", first.why)


def test_what_fails_gives_way_to_what_passes(picked: tuple[Candidate, ...]):
    works = next(
        c for c in picked if isinstance(rehearsal(standing_on_the_belt()).approach(request(c, c.goals[0])), Approach)
    )
    Ts_away = works.among.Ts_object_grasp.copy()
    Ts_away[-1] = Pose.of((0.0, 0.0, 3.0)).matrix
    away = replace(works, index=-1, among=replace(works.among, Ts_object_grasp=Ts_away))
    left, refused = rehearsal(standing_on_the_belt()).from_the_first_that_works((away, works), None, request)
    assert [c.index for c in left] == [works.index]
    assert len(left[0].goals) >= 1
    assert set(refused) == {-1} and refused[-1].startswith("in rehearsal: ")


def test_without_rehearsal_only_the_arm_itself_is_in_its_own_way(picked: tuple[Candidate, ...]):
    scene = standing_on_the_belt()
    scene.add_object(load_object("sugar_box"), START)
    asked = request(picked[0], picked[0].goals[0])
    assert isinstance(rehearsal(scene).approach(asked), Refusal)
    assert isinstance(replace(rehearsal(scene), wanted=False).approach(asked), Approach)
    slow = replace(rehearsal(standing_on_the_belt(), 1e-4), wanted=False)
    assert isinstance(slow.approach(asked), Refusal)
    assert slow.from_the_first_that_works(picked, None, request) == (picked, {})


def test_when_none_passes_all_are_left(picked: tuple[Candidate, ...]):
    left, refused = rehearsal(standing_on_the_belt(), 1e-4).from_the_first_that_works(picked, None, request)
    assert left == picked
    assert refused and list(refused) == [c.index for c in picked[: len(refused)]]
    assert all("too slow" in why for why in refused.values())


def test_in_one_cycle_only_so_many_are_tried(picked: tuple[Candidate, ...]):
    slow = rehearsal(standing_on_the_belt(), 1e-4)
    many = tuple(replace(picked[0], index=i, goals=picked[0].goals[:1]) for i in range(2 * MOST_AT_ONCE))
    left, refused = slow.from_the_first_that_works(many, None, request)
    assert set(refused) == set(range(MOST_AT_ONCE)) and left == many


def test_what_has_passed_a_moment_ago_is_trusted(picked: tuple[Candidate, ...]):
    slow = rehearsal(standing_on_the_belt(), 1e-4)
    left, refused = slow.from_the_first_that_works(picked, picked[1].index, request)
    assert left == picked[1:]
    assert set(refused) == {picked[0].index}


def sweep(begin_s: float, candidate: Candidate) -> Trajectory:
    """From 0.8 rad of the first joint before the grasp to as much after it, in 4 s: halfway it stands in the object."""
    q = candidate.goals[0].q_grasp
    aside = np.array([0.8, 0.0, 0.0, 0.0, 0.0, 0.0])
    return Trajectory(begin_s + np.array([0.0, 4.0]), np.stack([q - aside, q + aside]), np.tile(aside / 2.0, (2, 1)))


def test_a_motion_through_the_object_as_it_moves_is_told_and_when(picked: tuple[Candidate, ...]):
    scene = standing_on_the_belt()
    words = rehearsal(scene).brushes(sweep(0.0, picked[0]), 10.0, object_at)
    told = re.fullmatch(r"in ([\d.]+) s \S+ too near to the (cube|tray)", words)
    assert told
    blocked = [not free_at(scene, sweep(0.0, picked[0]), t_s) for t_s in np.arange(0.0, 4.0, 0.1)]
    assert float(told[1]) == pytest.approx(0.1 * blocked.index(True))
    assert rehearsal(scene).brushes(sweep(0.0, picked[0]), float(told[1]) - 0.05, object_at) == ""
    assert replace(rehearsal(scene), wanted=False).brushes(sweep(0.0, picked[0]), 10.0, object_at) == ""


def test_a_motion_through_where_the_object_has_been_is_not(picked: tuple[Candidate, ...]):
    away_s = 0.5 / float(SPEED_MPS[1])
    assert rehearsal(standing_on_the_belt()).brushes(sweep(away_s, picked[0]), away_s + 10.0, object_at) == ""


def test_an_arm_that_touches_already_may_move_away(picked: tuple[Candidate, ...]):
    q = picked[0].goals[0].q_grasp
    away = Trajectory(np.array([0.0, 2.0]), np.stack([q, picked[0].goals[0].q_pregrasp]), np.zeros((2, 6)))
    scene = standing_on_the_belt()
    assert not free_at(scene, away, 0.0)
    assert rehearsal(scene).brushes(away, 10.0, object_at) == ""


def free_at(scene: PlanningScene, trajectory: Trajectory, t_s: float) -> bool:
    scene.move_target(Pose(object_at(np.array([t_s]))[0]))
    return scene.is_free(trajectory.sample(t_s)[0])
