"""Measures a motion-aware model in fresh attempts: its agreement, what chance leaves to be known, and its ranking."""

from __future__ import annotations

from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from backend.build.attempts import Attempts
from backend.build.motion_data import AttemptRig, Case, Source, attempted, columns, draw, draw_misplaced
from backend.build.motion_metrics import agreement
from backend.knowledge.motion_aware import MotionAwareModel, sigmoid
from backend.pose import Array, Pose

REPEATS = 10
"""Attempts of one case with different misplacements, to see what chance decides."""
TOP = 5
"""As many of the best as R+M takes."""
FAR_M = 0.015
"""A grasp whose tcp is this far from the database's grasp that it was drawn around is far beside it."""
REPEATED, RANKED = 1, 2
"""Streams of chance, beside that of the draws."""


@dataclass(frozen=True)
class Chance:
    """What cases repeated with other misplacements say about the best that any model can do."""

    cases: int
    accuracy: float
    """Of saying for each attempt what the majority of its case's other attempts did; with ``REPEATS`` attempts a
    little less than the true cap."""
    brier: float
    """Unbiased estimate of the mean squared difference that even the true probabilities have."""


@dataclass(frozen=True)
class Worth:
    """Success of the best grasps by the model and of any grasp of the database, in the same motions."""

    motions: int
    ranked: float
    """Share held of one of the ``TOP`` best, each in turn."""
    anyhow: float
    """Share held of a grasp of the database drawn at random."""
    standard_error: float
    """Of the difference, over the paired motions."""


def measure(source: Source, model: MotionAwareModel, count: int, trained: int) -> dict[str, Any]:
    """Agreement in ``count`` fresh attempts drawn as in training, the cap by chance, and the worth of the ranking.

    ``trained`` draws are left out: the model may have seen them.
    """
    cases = [draw(source, index) for index in range(trained, trained + count)]
    with source.make_rig(source.robot, source.object) as rig:
        fresh = columns(cases, [attempted(rig, case) for case in cases])
        of_chance = chance(repeated(rig, source, cases[: max(count // REPEATS, 1)]))
        of_rank = worth(rig, source, model, count)
    return {"fresh": by_distance(source, model, fresh), "chance": asdict(of_chance), "worth": asdict(of_rank)}


def by_distance(source: Source, model: MotionAwareModel, attempts: Attempts) -> dict[str, dict[str, Any]]:
    """Agreement in all ``attempts``, and by how far the tcp was from the database's grasp; bands with none left out."""
    shift_m = np.linalg.norm(attempts.Ts_object_grasp[:, :3, 3] - source.Ts_object_grasp[attempts.grasp, :3, 3], axis=1)
    as_it_is = attempts.variant == 0
    bands = {
        "all": np.ones(len(attempts), np.bool_),
        "as in the database": as_it_is,
        f"less than {1000 * FAR_M:.0f} mm beside": ~as_it_is & (shift_m < FAR_M),
        f"{1000 * FAR_M:.0f} mm or more beside": ~as_it_is & (shift_m >= FAR_M),
    }
    said = probabilities(model, attempts)
    return {name: asdict(agreement(said[rows], attempts.held[rows])) for name, rows in bands.items() if rows.any()}


def probabilities(model: MotionAwareModel, attempts: Attempts) -> Array:
    """(n,) what the model says of attempts."""
    return sigmoid(model.logits(attempts.Ts_object_grasp, attempts.speed_mps, attempts.direction_rad))


def repeated(rig: AttemptRig, source: Source, cases: list[Case]) -> Array:
    """(cases, REPEATS) 1 where an attempt held, 0 where not, each with a misplacement of its own."""
    held = np.zeros((len(cases), REPEATS))
    for i, case in enumerate(cases):
        rng = np.random.default_rng([source.seed, REPEATED, case.index])
        for k in range(REPEATS):
            again = replace(case, misplaced=draw_misplaced(source.settings, rng))
            held[i, k] = attempted(rig, again)[0]
    return held


def chance(held: Array) -> Chance:
    """The best that can be known of cases from their repeated attempts (cases, k), k at least 2."""
    k = held.shape[1]
    of_all = held.sum(axis=1)
    others = (of_all[:, None] - held) / (k - 1)
    right = np.where(others == 0.5, 0.5, (others > 0.5) == (held > 0.5))
    return Chance(len(held), float(right.mean()), float((of_all * (k - of_all) / (k * (k - 1))).mean()))


def worth(rig: AttemptRig, source: Source, model: MotionAwareModel, motions: int) -> Worth:
    """Try one of the best and any grasp of the database in each of ``motions`` random motions."""
    prepared = model.over(source.Ts_object_grasp)
    held = np.zeros((motions, 2))
    for i in range(motions):
        rng = np.random.default_rng([source.seed, RANKED, i])
        speed, direction = rng.uniform(*source.settings.speeds_mps), rng.uniform(-np.pi, np.pi)
        best = np.argsort(-prepared.quality(speed, direction), kind="stable")[:TOP]
        anyone = int(rng.integers(len(source.Ts_object_grasp)))
        misplaced = draw_misplaced(source.settings, rng)
        velocity = speed * np.array([np.cos(direction), np.sin(direction)])
        for column, grasp in enumerate((int(best[i % len(best)]), anyone)):
            case = Case(i, grasp, 0, Pose(source.Ts_object_grasp[grasp]), misplaced, velocity)
            held[i, column] = attempted(rig, case)[0]
    off = held[:, 0] - held[:, 1]
    ranked, anyhow = held.mean(axis=0).tolist()
    return Worth(motions, ranked, anyhow, float(off.std() / np.sqrt(motions)))
