"""The oracle a reachability field is measured against: exhaustive IK and contact, and the poses it is asked about."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from backend.kinematics import Kinematics
from backend.knowledge.grasps import load_grasps
from backend.objects import OBJECTS, load_object
from backend.pipeline.convert import convert
from backend.pose import Array, Pose, rotation_from_wxyz
from backend.scenario import load_scenario, scenario_names
from backend.sim.planning_scene import PlanningScene
from backend.tasks.setup import TrialSetup

Bools = NDArray[np.bool_]
OnProgress = Callable[[str], None]
QUICK_RESTARTS = 6
TRIES = 40
BRANCHES = 24
"""IK of a pose: a quick solution first; where it is none or touches something, every branch that 40 tries find."""
CELL_M, CELL_RAD = 0.10, float(np.radians(36.0))
"""Cell of the published grid; a pose is near the border when one of the other kind lies within a cell of it."""


class Oracle:
    """Says whether an arm reaches a pose, touching neither itself nor the floor."""

    def __init__(self, kinematics: Kinematics) -> None:
        self._kinematics = kinematics
        self._scene = PlanningScene(kinematics)
        self._near = np.array(kinematics.description.home_rad)

    def reachable(self, Ts_world_tcp: Array) -> Bools:
        """(n,) for (n, 4, 4)."""
        qs, found = self._kinematics.ik_many(Ts_world_tcp, self._near, QUICK_RESTARTS)
        out = np.zeros(len(Ts_world_tcp), dtype=np.bool_)
        out[found] = self._scene.free_many(qs[found])
        for i in np.flatnonzero(~out):
            out[i] = len(self.free_postures(Ts_world_tcp[i])) > 0
        return out

    def free_postures(self, T_world_tcp: Array) -> Array:
        """(k, dof) the free ones of all the branches found."""
        qs = self._kinematics.ik_branches(T_world_tcp, self._near, BRANCHES, TRIES)
        return qs[self._scene.free_many(qs)] if len(qs) else qs


def random_poses(rng: np.random.Generator, count: int, reach_m: float, height_m: float, steepest_rad: float) -> Array:
    """(count, 4, 4) uniform in a cylinder round the base and over the approaches up to ``steepest_rad`` from down."""
    Ts = np.empty((0, 4, 4))
    while len(Ts) < count:
        some = np.tile(np.eye(4), (2 * count, 1, 1))
        wxyz = rng.standard_normal((2 * count, 4))
        some[:, :3, :3] = _rotations(wxyz / np.linalg.norm(wxyz, axis=1, keepdims=True))
        radius, azimuth = reach_m * np.sqrt(rng.random(2 * count)), 2.0 * np.pi * rng.random(2 * count)
        some[:, 0, 3], some[:, 1, 3] = radius * np.cos(azimuth), radius * np.sin(azimuth)
        some[:, 2, 3] = height_m * rng.random(2 * count)
        Ts = np.concatenate([Ts, some[-some[:, 2, 2] >= np.cos(steepest_rad)]])
    return Ts[:count]


def nudged(rng: np.random.Generator, Ts: Array) -> Array:
    """Each pose moved by up to a cell: uniform in a box of +-10 cm, and by up to 36 degrees about a random axis."""
    out = Ts.copy()
    out[:, :3, 3] += rng.uniform(-CELL_M, CELL_M, (len(Ts), 3))
    axis = rng.standard_normal((len(Ts), 3))
    half = 0.5 * CELL_RAD * rng.random(len(Ts))
    axis *= (np.sin(half) / np.linalg.norm(axis, axis=1))[:, None]
    out[:, :3, :3] = _rotations(np.column_stack([np.cos(half), axis])) @ out[:, :3, :3]
    return out


def border_poses(
    rng: np.random.Generator, oracle: Oracle, count: int, domain: tuple[float, float, float], on_progress: OnProgress
) -> tuple[Array, Bools]:
    """(count, 4, 4) and labels: pairs within a cell of each other of which one is reachable and one is not."""
    reach_m, height_m, steepest_rad = domain
    poses: list[Array] = []
    labels: list[Bools] = []
    have = 0
    while have < count:
        first = random_poses(rng, 2000, reach_m, height_m, steepest_rad)
        second = nudged(rng, first)
        a, b = oracle.reachable(first), oracle.reachable(second)
        inside = (second[:, 2, 3] >= 0.0) & (second[:, 2, 3] <= height_m)
        inside &= -second[:, 2, 2] >= np.cos(steepest_rad)
        pairs = np.flatnonzero((a != b) & inside)
        poses += [first[pairs], second[pairs]]
        labels += [a[pairs], b[pairs]]
        have += 2 * len(pairs)
        on_progress(f"near the border {min(have, count)} of {count}")
    return np.concatenate(poses)[:count], np.concatenate(labels)[:count]


def belt_poses(rng: np.random.Generator, kinematics: Kinematics, count: int) -> tuple[Array, Array]:
    """(count, 4, 4) grasps of the databases on belts as the tasks draw them, and (count, 3) the objects' velocities."""
    names = [name for name in scenario_names() if load_scenario(name).robot == kinematics.description.name]
    spheres = kinematics.spheres_world(np.array(kinematics.description.home_rad))
    per_belt = 25
    poses, speeds = np.empty((count, 4, 4)), np.empty((count, 3))
    for i in range(0, count, per_belt):
        target = load_object(str(rng.choice(sorted(OBJECTS))))
        task = load_scenario(str(rng.choice(names))).task
        setup: TrialSetup = task.draw(rng, target, spheres)
        t_s = float(rng.uniform(0.0, setup.motion.duration_s))
        grasps = load_grasps(kinematics.description.name, target.name)
        some = convert(grasps, object_at(setup, t_s), kinematics.description.backoff_m)
        picked = rng.integers(len(grasps), size=min(per_belt, count - i))
        stop = i + len(picked)
        poses[i:stop] = some.Ts_world_grasp[picked]
        poses[i:stop:2] = some.Ts_world_pregrasp[picked[::2]]
        speeds[i:stop] = setup.motion.velocity_at(t_s)
    return poses, speeds


def object_at(setup: TrialSetup, t_s: float) -> Pose:
    """T_world_object."""
    return setup.motion.pose_at(t_s) @ setup.T_tray_object


def _rotations(wxyz: Array) -> Array:
    """(n, 3, 3) of (n, 4) unit quaternions."""
    return np.array([rotation_from_wxyz(row) for row in wxyz]).reshape(-1, 3, 3)
