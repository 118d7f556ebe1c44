"""What the paper reports: its table of simulation experiments, cell by cell.

Akinola, Xu, Song, Allen: Dynamic Grasping with Reachability and Motion Awareness (2021), table I: 7 objects with 100
trials each in every cell.
"""

from dataclasses import dataclass

PAPERS_TASKS = (
    "linear",
    "linear_obstacles",
    "linear_slab",
    "linear_z",
    "linear_varying",
    "circular",
    "sinusoidal",
)
"""The table's columns."""
PAPERS_TRIALS = 700
_Columns = dict[str, dict[str, tuple[float, ...]]]
"""Robot, method -> a number per column."""
_SUCCESS: _Columns = {
    "mico": {
        "ours_rm": (0.799, 0.796, 0.781, 0.814, 0.869, 0.875, 0.895),
        "reachability": (0.802, 0.795, 0.759, 0.806, 0.836, 0.861, 0.867),
        "motion_aware": (0.722, 0.780, 0.697, 0.710, 0.819, 0.857, 0.827),
        "baseline": (0.439, 0.419, 0.431, 0.430, 0.610, 0.716, 0.643),
        "no_seeding": (0.769, 0.777, 0.706, 0.800, 0.827, 0.857, 0.827),
        "no_prediction": (0.610, 0.614, 0.609, 0.737, 0.761, 0.767, 0.807),
    },
    "ur5_robotiq": {
        "ours_rm": (0.874, 0.854, 0.748, 0.858, 0.917, 0.909, 0.946),
        "reachability": (0.857, 0.841, 0.652, 0.872, 0.907, 0.890, 0.925),
        "motion_aware": (0.744, 0.752, 0.675, 0.717, 0.854, 0.840, 0.930),
        "baseline": (0.676, 0.576, 0.606, 0.659, 0.788, 0.810, 0.716),
        "no_seeding": (0.849, 0.810, 0.631, 0.836, 0.906, 0.899, 0.904),
        "no_prediction": (0.284, 0.269, 0.457, 0.261, 0.344, 0.594, 0.310),
    },
}
_TIME_S: _Columns = {
    "mico": {
        "ours_rm": (10.23, 11.43, 21.92, 10.39, 9.988, 10.38, 8.661),
        "reachability": (10.21, 10.13, 19.91, 9.836, 9.609, 9.421, 7.857),
        "motion_aware": (15.3, 14.37, 25.07, 14.61, 14.45, 15.43, 13.19),
        "baseline": (23.85, 24.15, 38.12, 23.19, 25.72, 24.89, 20.22),
        "no_seeding": (10.61, 10.83, 22.29, 10.41, 10.23, 10.01, 8.588),
        "no_prediction": (12.91, 13.3, 25.84, 12.6, 11.96, 13.11, 9.045),
    },
    "ur5_robotiq": {
        "ours_rm": (8.134, 9.104, 19.86, 8.166, 7.895, 8.311, 9.243),
        "reachability": (8.73, 9.646, 18.52, 8.864, 8.748, 9.512, 8.608),
        "motion_aware": (9.976, 9.896, 19.86, 10.47, 8.935, 10.68, 9.645),
        "baseline": (12.64, 13.63, 22.89, 12.65, 12.84, 14.09, 17.19),
        "no_seeding": (9.107, 10.22, 20.01, 9.047, 8.859, 9.61, 11.17),
        "no_prediction": (10.31, 11.41, 20.04, 10.89, 10.44, 9.891, 11.96),
    },
}


@dataclass(frozen=True)
class PapersCell:
    """One entry of the table."""

    success: float
    time_s: float
    """Dynamic grasping time, averaged over all trials."""


def papers_cell(robot: str, task: str, method: str) -> PapersCell | None:
    """What the paper reports; None where it reports nothing."""
    if method not in _SUCCESS.get(robot, {}) or task not in PAPERS_TASKS:
        return None
    column = PAPERS_TASKS.index(task)
    return PapersCell(_SUCCESS[robot][method][column], _TIME_S[robot][method][column])
