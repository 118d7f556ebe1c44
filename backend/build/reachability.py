"""Builds an arm's reachability field: IK branches on a grid of the chart, borders between vertices, distances."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from importlib.metadata import version
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from backend.build import reach_border, reach_branches
from backend.errors import InvalidInputError
from backend.kinematics import Kinematics
from backend.kinematics.bodies import BodyTable
from backend.kinematics.collision import BodyArrays, Margins, RobotArrays
from backend.kinematics.spheres import HAND, LEVEL
from backend.knowledge.reachability import METRES_PER_RADIAN, ReachabilityField
from backend.pose import Array, inverse
from backend.sim.planning_scene import SELF_MARGIN_M, SURFACE_MARGIN_M

OnProgress = Callable[[str], None]
STEPS_TO_REACH = 33
"""Position steps from the base's axis to the farthest tcp."""
SPANS = 200
"""Pieces the long walks are cut into, for progress and for threads."""


@dataclass(frozen=True)
class ReachabilitySettings:
    """How fine a field is, and how much work goes into it."""

    position_step_m: float | None = None
    """None: a share of how far the arm reaches."""
    height_max_m: float = 0.9
    """Of the tcp; higher poses count as unreachable."""
    approach_step_rad: float = 0.15
    theta_max_rad: float = float(np.radians(120.0))
    rolls: int = 12
    cap_m: float = 0.2
    """Distances are cut here."""
    quantum_m: float = 0.0025
    postures: int = 3_000_000
    """Random postures that branches grow from."""
    branches: int = 8
    """IK solutions kept at a vertex."""
    halvings: int = 3
    """How often an edge is halved to find the border on it."""
    walks: int = 3
    """Walks through the grid that carry branches to neighbours."""
    sweeps: int = 16


@dataclass(frozen=True, eq=False)
class _Grid:
    shape: reach_branches.Shape
    origin: Array
    steps: Array
    wanted: NDArray[np.bool_]
    """(u, v) whether interpolation below ``theta_max_rad`` asks for that approach."""

    @property
    def numbers(self) -> tuple[reach_branches.Shape, Array, Array]:
        return self.shape, self.origin, self.steps

    @property
    def vertices(self) -> int:
        return int(np.prod(self.shape[:4]))


def build_reachability(
    kinematics: Kinematics,
    seed: int,
    on_progress: OnProgress,
    workers: int = 1,
    settings: ReachabilitySettings | None = None,
) -> ReachabilityField:
    """The field of one arm. Same arguments but ``workers``, same field.

    Raises ``InvalidInputError`` when the arm lacks the two turns that the chart leaves out: a first joint about the
    base's z, and a last one about the approach.
    """
    settings = settings or ReachabilitySettings()
    last_sign = _last_sign(kinematics)
    postures = _postures(kinematics, settings.postures, np.random.default_rng(seed))
    grid = _grid(kinematics, settings, postures)
    branches = np.zeros((grid.vertices, settings.branches, kinematics.dof), dtype=np.float32)
    counts = np.zeros(grid.vertices, dtype=np.uint8)
    links, limits = kinematics.chain.links, kinematics.limits
    signs = (kinematics.yaw_sign, last_sign)
    for i, some in enumerate(np.array_split(postures, 10)):
        reach_branches.sow(links, limits, signs, grid.numbers, grid.wanted, some, branches, counts)
        on_progress(f"branches from postures {10 * i + 10} %")
    for i in range(settings.walks):
        fresh = reach_branches.spread(links, limits, grid.numbers, grid.wanted, i % 2 == 1, branches, counts)
        on_progress(f"branches from neighbours: {fresh} new, {counts.sum()} in all")
    robot, bodies, margins = scene_arrays(kinematics)
    rolls = grid.shape[4]
    reachable = np.zeros((grid.vertices, rolls), dtype=np.bool_)

    roll_step = last_sign * float(grid.steps[4])

    def label(span: tuple[int, int]) -> None:
        reach_branches.label(robot, bodies, margins, roll_step, span, branches, counts, reachable)

    _each_span(label, grid.vertices, workers, on_progress, "contacts")
    shares = np.full((grid.vertices, rolls, 5), reach_border.NONE, dtype=np.uint8)
    scene, found = (robot, bodies, margins, limits), (branches, counts, reachable)

    def borders(span: tuple[int, int]) -> None:
        reach_border.find_roll_borders(scene, roll_step, settings.halvings, span, found, shares)
        reach_border.find_place_borders(
            scene, grid.numbers, grid.wanted, roll_step, settings.halvings, span, found, shares
        )

    _each_span(borders, grid.vertices, workers, on_progress, "borders")
    distance = _distances(grid, settings, shares, on_progress)
    signed = np.where(reachable, distance, -distance).reshape(grid.shape)
    facts: dict[str, Any] = {
        "seed": seed,
        "settings": asdict(settings),
        "versions": {name: version(name) for name in ("numpy", "numba", "dynamic-grasping")},
        "branches": int(counts.sum()),
        "reachable_share": float(reachable.mean()),
    }
    return ReachabilityField(
        robot=kinematics.description.name,
        levels=np.clip(np.rint(signed / settings.quantum_m), -127, 127).astype(np.int8),
        origin=grid.origin,
        steps=grid.steps,
        quantum_m=settings.quantum_m,
        theta_max_rad=settings.theta_max_rad,
        hand=hand_spheres(kinematics),
        floor_margin_m=SURFACE_MARGIN_M,
        facts=facts,
    )


def hand_spheres(kinematics: Kinematics) -> Array:
    """(n, 4) spheres of the open hand in the tcp frame."""
    q = np.zeros(kinematics.dof)
    spheres = kinematics.spheres_world(q)
    T_tcp_world = inverse(kinematics.fk(q))
    model = kinematics.spheres
    of_hand = [spheres[a:b] for (_, a, b), (*_, flags) in zip(model.index, model.trees, strict=True) if flags & HAND]
    hand = np.concatenate(of_hand)
    return np.column_stack([hand[:, :3] @ T_tcp_world[:3, :3].T + T_tcp_world[:3, 3], hand[:, 3]])


def scene_arrays(kinematics: Kinematics) -> tuple[RobotArrays, BodyArrays, Margins]:
    """What collision kernels ask for: the arm alone on the floor, which its hand does not notice."""
    model = kinematics.spheres
    trees = model.trees.copy()
    trees[:, 3] |= np.where(trees[:, 3] & HAND, LEVEL, 0)
    robot = (kinematics.chain.links, model.nodes, model.skips, trees, model.pairs)
    return robot, BodyTable().arrays, (SURFACE_MARGIN_M, SELF_MARGIN_M)


def _last_sign(kinematics: Kinematics) -> float:
    """+1 or -1: how the last joint turns the hand about its approach."""
    q = np.array(kinematics.description.home_rad)
    turned = q.copy()
    turned[-1] += 0.5
    T = inverse(kinematics.fk(q)) @ kinematics.fk(turned)
    spans = kinematics.limits[1] - kinematics.limits[0]
    about_approach = abs(T[2, 2] - 1.0) < 1e-6 and float(np.abs(T[:3, 3]).max()) < 1e-6
    if kinematics.yaw_sign == 0.0 or not about_approach or min(spans[0], spans[-1]) < 2.0 * np.pi - 1e-3:
        raise InvalidInputError(
            f"{kinematics.description.name}: a reachability field needs a first joint that turns freely about the "
            "base's z and a last one that turns freely about the hand's approach."
        )
    return float(np.sign(T[1, 0]))


def _postures(kinematics: Kinematics, count: int, rng: np.random.Generator) -> Array:
    """(count, dof) random within limits, at most one turn of each joint."""
    lower, upper = kinematics.limits
    whole = upper - lower >= 2.0 * np.pi
    lower, upper = np.where(whole, -np.pi, lower), np.where(whole, np.pi, upper)
    return lower + rng.random((count, kinematics.dof)) * (upper - lower)


def _grid(kinematics: Kinematics, settings: ReachabilitySettings, postures: Array) -> _Grid:
    """From the axis to a cell beyond the farthest posture, from the floor up, round every approach."""
    reached = kinematics.fk_many(postures[:200_000])[:, :3, 3]
    farthest_m = float(np.hypot(reached[:, 0], reached[:, 1]).max())
    highest_m = min(settings.height_max_m, float(reached[:, 2].max()))
    step_m = settings.position_step_m or farthest_m / STEPS_TO_REACH
    step_rad = settings.approach_step_rad
    half = int(np.ceil(settings.theta_max_rad / step_rad)) + 1
    side = 2 * half + 1
    bend = step_rad * (np.arange(side) - half)
    theta = np.hypot(bend[:, None], bend[None, :])
    return _Grid(
        shape=(
            int(np.ceil(farthest_m / step_m)) + 2,
            int(np.ceil(highest_m / step_m)) + 1,
            side,
            side,
            settings.rolls,
        ),
        origin=np.array([0.0, 0.0, bend[0], bend[0], 0.0]),
        steps=np.array([step_m, step_m, step_rad, step_rad, 2.0 * np.pi / settings.rolls]),
        wanted=theta <= min(settings.theta_max_rad + 1.5 * step_rad, np.pi - 0.5 * step_rad),
    )


def _each_span(
    work: Callable[[tuple[int, int]], None], total: int, workers: int, on_progress: OnProgress, what: str
) -> None:
    """Do ``work`` on every piece of ``range(total)``; its kernels let go of the interpreter's lock."""
    cuts = np.linspace(0, total, SPANS + 1).astype(int).tolist()
    with ThreadPoolExecutor(workers) as pool:
        for i, _ in enumerate(pool.map(work, pairwise(cuts))):
            if i % 20 == 19:
                on_progress(f"{what} {100 * (i + 1) // SPANS} %")


def _distances(
    grid: _Grid, settings: ReachabilitySettings, shares: reach_border.Shares, on_progress: OnProgress
) -> Array:
    """(vertices, rolls) unsigned distance to the border, cut at ``cap_m``."""
    distance = np.empty(shares.shape[:2])
    reach_border.fill_near(grid.numbers, METRES_PER_RADIAN, settings.halvings, shares, distance)
    fixed = np.isfinite(distance)
    distance = np.minimum(distance, settings.cap_m)
    for i in range(settings.sweeps):
        change_m = reach_border.sweep(
            grid.numbers, METRES_PER_RADIAN, grid.wanted, fixed, i % 2 == 1, settings.cap_m, distance
        )
        on_progress(f"distances: walk {i + 1} changed at most {1e3 * change_m:.1f} mm")
        if change_m < 1e-3:
            break
    return distance
