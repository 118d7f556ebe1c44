"""Funnel: how few of all grasps are left after each room, and why the others are not."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass

import numpy as np

from backend.pipeline.values import Candidate, Shortlist
from backend.pose import Array, Pose


@dataclass(frozen=True)
class Stage:
    """What is left."""

    name: str
    count: int


def funnel(short: Shortlist, picked: Candidate | None) -> list[Stage]:
    """From the database to the picked grasp; stages that the filter has not asked about are left out."""
    stages = [Stage("in the database", len(short.score))]
    reachable = reachable_count(short)
    if reachable is not None:
        stages.append(Stage("reachable", reachable))
    stages.append(Stage("shortlisted", len(short.kept)))
    stages.append(Stage("solved by IK", sum(1 for i in short.kept if i not in short.rejected)))
    stages.append(Stage("picked", int(picked is not None)))
    return stages


def reachable_count(short: Shortlist) -> int | None:
    """By the field where it was asked, else by IK where every grasp was solved for; None where nobody asked."""
    if short.reachability_m is not None:
        return int((short.reachability_m > 0.0).sum())
    if short.motion_quality is None and np.isfinite(short.score).any():
        return int(np.isfinite(short.score).sum())
    return None


def rejections(short: Shortlist) -> list[tuple[str, list[int]]]:
    """Reason -> grasps, the commonest first; figures in a reason are left out, so that like is counted with like."""
    groups: defaultdict[str, list[int]] = defaultdict(list)
    for i, why in sorted(short.rejected.items()):
        groups[why.split(" by about")[0].split(";")[0]].append(i)
    return sorted(groups.items(), key=lambda item: -len(item[1]))


def ranges(indices: list[int]) -> str:
    """Increasing numbers in short: 0-3, 7, 9-11."""
    runs: list[tuple[int, int]] = []
    for i in indices:
        if runs and runs[-1][1] == i - 1:
            runs[-1] = runs[-1][0], i
        else:
            runs.append((i, i))
    return ", ".join(str(a) if a == b else f"{a}-{b}" for a, b in runs)


def columns(short: Shortlist) -> list[tuple[str, list[str]]]:
    """Figures of every grasp: what the filter ranked by, and how far the arm has to go."""
    out: list[tuple[str, list[str]]] = []
    if short.reachability_m is not None:
        out.append(("R cm", _figures(short.reachability_m, 100.0, 1)))
    if short.motion_quality is not None:
        out.append(("M %", _figures(short.motion_quality, 100.0, 0)))
    if not out and np.isfinite(short.score).any():
        out.append(("score", _figures(short.score, 1.0, 3)))
    ways = [short.joint_distance_rad.get(i, np.nan) for i in range(len(short.score))]
    out.append(("way °", _figures(np.degrees(ways), 1.0, 0)))
    return out


def card_rows(short: Shortlist, index: int, picked: Candidate | None) -> list[tuple[str, str]]:
    """Everything known of one grasp."""
    quality = f"{100.0 * short.candidates.quality[index]:.0f} %"
    names = {"R cm": "Reachability, cm", "M %": "Holds in motion, %", "way °": "Joint distance, °", "score": "Score"}
    rows = [("Comes from", side_of(Pose(short.candidates.Ts_object_grasp[index]))), ("Lifted in tests", quality)]
    rows += [(names[head], figures[index]) for head, figures in columns(short)]
    rank = f"{short.kept.index(index) + 1} of {len(short.kept)}" if index in short.kept else "not shortlisted"
    became = "picked" if picked is not None and picked.index == index else short.rejected.get(index, "a spare")
    return [*rows, ("Rank", rank), ("Became", became)]


def side_of(T_object_grasp: Pose) -> str:
    """Where the hand comes from, seen from the object."""
    x, y, z = (-T_object_grasp.rotation[:, 2]).tolist()
    names = {"above": z, "+x": x, "-x": -x, "+y": y, "-y": -y, "below": -z}
    return max(names, key=lambda name: names[name])


def _figures(values: Array, unit: float, digits: int) -> list[str]:
    return [f"{unit * value:.{digits}f}" if np.isfinite(value) else "-" for value in values]
