"""Signals: what is plotted of the last minute, worked out from the page's own history without a screen."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from app.history import Moment
from app.ui import palette
from app.ui.palette import Rgb
from backend.pipeline.values import CycleResult, Room
from backend.pose import Array
from backend.snapshot import Snapshot

MOST = 150
"""Samples of a line: more than pixels would show."""
WIDEST_GAP_S = 0.5
"""Between two moments farther apart than this nothing is known of the truth."""
CM_PER_M, MM_PER_M, MS_PER_S, PERCENT = 100.0, 1e3, 1e3, 100.0
AHEAD: tuple[tuple[str, Rgb], ...] = (
    ("thinking ends", palette.TRAIL),
    ("arm arrives", palette.PREDICTION),
    ("approach ends", palette.SEED_PLAN),
)
"""For when a cycle predicts where the object is, soonest first."""
ROOMS: tuple[Room, ...] = ("predict", "convert", "filter", "pick", "plan", "retime")


@dataclass(frozen=True, eq=False)
class Line:
    """One figure over time."""

    name: str
    color: Rgb
    t_s: Array
    """(n,) increasing."""
    values: Array
    """(n,) NaN where there is none."""

    def at(self, t_s: float) -> float:
        """The figure in force at a simulated time; NaN when there is none."""
        i = int(np.searchsorted(self.t_s, t_s + 1e-6)) - 1
        return float(self.values[i]) if i >= 0 else np.nan


@dataclass(frozen=True, eq=False)
class Plot:
    """Lines that share an axis."""

    title: str
    unit: str
    lines: tuple[Line, ...]
    limit: float | None = None
    """A figure not to be passed."""
    stacked: bool = False
    """Whether the lines are parts of a sum."""
    bursts: bool = False
    """Whether a few figures may be so large that the rest would not be seen beside them."""


def plots(moments: Sequence[Moment], limits_rps: Sequence[float], other: str = "") -> tuple[Plot, ...]:
    """Everything there is to plot; ``other`` is the method compared with, of which only the distance is shown."""
    few = thinned(moments)
    snapshots = [moment.snapshot for moment in few]
    cycles = cycles_in(moments)
    return (
        Plot("Hand to", "cm", distances(few, other)),
        Plot("Prediction error, when", "mm", prediction_errors(moments, cycles), bursts=True),
        Plot("Joint speed, of the limit", "%", joint_speeds(snapshots, limits_rps), limit=PERCENT),
        Plot("Hand presses with", "N", (_line("force", palette.PICKED, snapshots, lambda one: one.grip_n),)),
        Plot("Time per room", "ms", room_times(cycles), stacked=True, bursts=True),
    )


def thinned(moments: Sequence[Moment]) -> list[Moment]:
    """The first of every of at most ``MOST`` equal stretches of time, and the last of all."""
    if not moments:
        return []
    begin_s, end_s = moments[0].t_s, moments[-1].t_s
    bins = np.floor((np.array([moment.t_s for moment in moments]) - begin_s) / max((end_s - begin_s) / MOST, 1e-9))
    firsts = np.flatnonzero(np.diff(bins, prepend=-1.0))
    return [moments[i] for i in dict.fromkeys([*firsts.tolist(), len(moments) - 1])]


def cycles_in(moments: Sequence[Moment]) -> list[CycleResult]:
    """Every cycle once; of more than ``MOST`` evenly as many."""
    found: list[CycleResult] = []
    for moment in moments:
        cycle = moment.snapshot.cycle
        if cycle is not None and (not found or cycle is not found[-1]):
            found.append(cycle)
    return found if len(found) <= MOST else [found[i] for i in np.linspace(0, len(found) - 1, MOST).astype(int)]


def distances(moments: Sequence[Moment], other: str) -> tuple[Line, ...]:
    """From the hand to the pregrasp it moves to, and to the object; to the latter also of the other method."""
    snapshots = [moment.snapshot for moment in moments]
    lines = [
        _line("pregrasp", palette.PICKED, snapshots, _to_pregrasp_cm),
        _line("object", palette.PLAN, snapshots, _to_object_cm),
    ]
    beside = [moment.beside.snapshot for moment in moments if moment.beside is not None]
    if beside:
        lines.append(_line(f"object, {other}", palette.SEED_PLAN, beside, _to_object_cm))
    return tuple(lines)


def prediction_errors(moments: Sequence[Moment], cycles: Sequence[CycleResult]) -> tuple[Line, ...]:
    """Of each cycle's predictions, once their time has come, against where the object then really was.

    Only as long as the object rides on the belt: no prediction is about what the hand does with it.
    """
    riding = [moment.snapshot for moment in moments if moment.snapshot.phase in ("watch", "move", "approach")]
    told = [(cycle.observed_s, cycle.prediction) for cycle in cycles if cycle.prediction is not None]
    t_s = np.array([observed_s for observed_s, _ in told])
    lines: list[Line] = []
    for k, (name, color) in enumerate(AHEAD):
        ahead = [(prediction, k * (len(prediction.t_s) - 1) // 2) for _, prediction in told]
        true_m = true_positions(riding, np.array([prediction.t_s[i] for prediction, i in ahead]))
        said_m = np.array([prediction.Ts_world_object[i, :3, 3] for prediction, i in ahead]).reshape(-1, 3)
        lines.append(Line(name, color, t_s, MM_PER_M * np.linalg.norm(said_m - true_m, axis=1)))
    return tuple(lines)


def true_positions(snapshots: Sequence[Snapshot], t_s: Array) -> Array:
    """(n, 3) where the object was at those times (n,), between two snapshots each; NaN where there are none near."""
    if len(snapshots) < 2:
        return np.full((len(t_s), 3), np.nan)
    times = np.array([snapshot.t_s for snapshot in snapshots])
    places_m = np.array([snapshot.T_world_object.xyz_m for snapshot in snapshots])
    i = np.clip(np.searchsorted(times, t_s), 1, len(times) - 1)
    gap_s = times[i] - times[i - 1]
    known = (t_s >= times[0]) & (t_s <= times[-1]) & (gap_s > 0.0) & (gap_s <= WIDEST_GAP_S)
    share = np.where(known, (t_s - times[i - 1]) / np.where(known, gap_s, 1.0), np.nan)[:, None]
    return (1.0 - share) * places_m[i - 1] + share * places_m[i]


def joint_speeds(snapshots: Sequence[Snapshot], limits_rps: Sequence[float]) -> tuple[Line, ...]:
    """Mean of each joint between two samples, in percent of its limit."""
    t_s = np.array([snapshot.t_s for snapshot in snapshots])
    q = np.array([snapshot.q for snapshot in snapshots]).reshape(len(snapshots), len(limits_rps))
    took_s = np.diff(t_s)[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        shares = np.where(took_s > 0.0, np.abs(np.diff(q, axis=0)) / took_s, 0.0) / np.array(limits_rps)
    return tuple(
        Line(f"J{joint + 1}", palette.SERIES[joint % len(palette.SERIES)], t_s[1:], PERCENT * shares[:, joint])
        for joint in range(shares.shape[1])
    )


def room_times(cycles: Sequence[CycleResult]) -> tuple[Line, ...]:
    """Wall time of every room of each cycle."""
    t_s = np.array([cycle.observed_s for cycle in cycles])
    return tuple(
        Line(room, color, t_s, np.array([MS_PER_S * cycle.room_s.get(room, 0.0) for cycle in cycles]))
        for room, color in zip(ROOMS, palette.SERIES, strict=True)
    )


def _line(name: str, color: Rgb, snapshots: Sequence[Snapshot], figure: Callable[[Snapshot], float]) -> Line:
    return Line(name, color, np.array([one.t_s for one in snapshots]), np.array([figure(one) for one in snapshots]))


def _to_object_cm(snapshot: Snapshot) -> float:
    return CM_PER_M * float(np.linalg.norm(snapshot.T_world_tcp.xyz_m - snapshot.T_world_object.xyz_m))


def _to_pregrasp_cm(snapshot: Snapshot) -> float:
    """NaN once the arm goes in, and while no grasp is picked."""
    picked = snapshot.cycle.picked if snapshot.cycle else None
    if picked is None or snapshot.phase not in ("watch", "move"):
        return np.nan
    return CM_PER_M * float(np.linalg.norm(snapshot.T_world_tcp.xyz_m - picked.T_world_pregrasp.xyz_m))
