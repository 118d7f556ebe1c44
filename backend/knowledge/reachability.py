"""ReachabilityField: how far inside the reachable set a grasp pose lies, by interpolation in what was computed before.

Metric: ``d^2 = |dp|^2 + (METRES_PER_RADIAN * angle)^2`` between tcp poses; a third of a right angle counts as much as
8 cm. Positive is reachable. Two parts, of which the smaller counts: the arm's own field (IK within limits, no contact
of the robot with itself, of the arm with the floor) on a grid of the chart, and the height of the open hand above the
floor, which the pose alone decides.
"""

from __future__ import annotations

import lzma
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from backend.errors import lookup
from backend.kinematics.chain import rows_of
from backend.kinematics.compiled import kernel
from backend.knowledge.reach_chart import fill_coordinates
from backend.knowledge.shelf import ASSETS, Arrays, Label, read, write
from backend.pose import Array

PACKED_AXES = (4, 3)
METRES_PER_RADIAN = 0.15
"""A radian counts as this far: with it 36 degrees weigh about as much as 10 cm, as in the published grid."""
FORMAT = 1
Levels = NDArray[np.int8]


@dataclass(frozen=True, eq=False)
class ReachabilityField:
    """Signed distance of one arm's tcp poses to the border of what it can reach."""

    robot: str
    levels: Levels
    """(rho, z, u, v, roll) distance in ``quantum_m``; roll is periodic."""
    origin: Array
    """(5,) coordinates of the first vertex: m, m, rad, rad, rad."""
    steps: Array
    """(5,) between vertices."""
    quantum_m: float
    theta_max_rad: float
    """Largest angle of the approach from straight down that the grid holds."""
    hand: Array
    """(n, 4) spheres of the open hand in the tcp frame."""
    floor_margin_m: float
    shift_m: float = 0.0
    """Taken from every distance; calibrated against IK so that few unreachable poses are called reachable."""
    facts: dict[str, Any] = field(default_factory=dict[str, Any])
    """How it was made, and how good it is."""

    def signed_distance(self, Ts_world_tcp: Array) -> Array:
        """(n,) metres for (n, 4, 4): positive where the arm reaches the pose free of itself and the floor.

        Cut where the build cut it (``facts``). Beyond the grid: the value at its edge less the way there. A pose
        that is not finite is infinitely far away.
        """
        return self.parts(Ts_world_tcp).min(axis=1)

    def parts(self, Ts_world_tcp: Array) -> Array:
        """(n, 2) metres, of which ``signed_distance`` is the smaller: the arm's own distance, the open hand's height.

        For ranking the first one says more: every low grasp is near the floor, and stays so as the object moves on.
        """
        rows = np.ascontiguousarray(rows_of(np.asarray(Ts_world_tcp, dtype=np.float64)))
        out = np.empty((len(rows), 2))
        _look_up(
            self.levels,
            self.origin,
            self.steps,
            (self.quantum_m, self.theta_max_rad, self.floor_margin_m, self.shift_m),
            self.hand,
            rows,
            out,
        )
        return out


@kernel
def _look_up(
    levels: Levels,
    origin: Array,
    steps: Array,
    scalars: tuple[float, float, float, float],
    hand: Array,
    rows: Array,
    out: Array,
) -> None:
    quantum, theta_max, floor_margin, shift = scalars
    flat = levels.ravel()
    shape = levels.shape
    strides = (shape[1] * shape[2] * shape[3] * shape[4], shape[2] * shape[3] * shape[4], shape[3] * shape[4], shape[4])
    x, share = np.empty(5), np.empty(5)
    low, high = np.empty(5, dtype=np.int64), np.empty(5, dtype=np.int64)
    for i in range(rows.shape[0]):
        if not np.isfinite(np.sum(rows[i])):
            out[i, :] = -np.inf
            continue
        fill_coordinates(rows[i], x)
        beyond = 0.0
        theta = np.hypot(x[2], x[3])
        if theta > theta_max:
            beyond += (METRES_PER_RADIAN * (theta - theta_max)) ** 2
            x[2] *= theta_max / theta
            x[3] *= theta_max / theta
        for axis in range(4):
            place = (x[axis] - origin[axis]) / steps[axis]
            inside = min(max(place, 0.0), shape[axis] - 1.0)
            if axis < 2:
                beyond += ((place - inside) * steps[axis]) ** 2
            cell = min(int(inside), shape[axis] - 2)
            share[axis] = inside - cell
            low[axis], high[axis] = cell * strides[axis], (cell + 1) * strides[axis]
        place = (x[4] - origin[4]) / steps[4]
        cell = int(np.floor(place))
        share[4] = place - cell
        low[4], high[4] = cell % shape[4], (cell + 1) % shape[4]
        total = 0.0
        for a in range(2):
            at_a, weight_a = (high[0], share[0]) if a else (low[0], 1.0 - share[0])
            for b in range(2):
                at_b, weight_b = (high[1], share[1]) if b else (low[1], 1.0 - share[1])
                for c in range(2):
                    at_c, weight_c = (high[2], share[2]) if c else (low[2], 1.0 - share[2])
                    for d in range(2):
                        at_d, weight_d = (high[3], share[3]) if d else (low[3], 1.0 - share[3])
                        at = at_a + at_b + at_c + at_d
                        value = (1.0 - share[4]) * flat[at + low[4]] + share[4] * flat[at + high[4]]
                        total += weight_a * weight_b * weight_c * weight_d * value
        lowest = np.inf
        for k in range(hand.shape[0]):
            height = rows[i, 6] * hand[k, 0] + rows[i, 7] * hand[k, 1] + rows[i, 8] * hand[k, 2] - hand[k, 3]
            lowest = min(lowest, height)
        out[i, 0] = quantum * total - np.sqrt(beyond) - shift
        out[i, 1] = lowest + rows[i, 11] - floor_margin


@cache
def load_reachability(robot: str) -> ReachabilityField:
    """The field that comes with the project, its kernel compiled.

    Raises ``NotFoundError`` for an unknown robot, ``MissingResourceError`` for a field that was not built, and
    ``InvalidInputError`` for a file that is broken or belongs to something else.
    """
    from backend.robots import ROBOTS

    lookup("robot", robot, ROBOTS)
    reach = read_reachability(reachability_file(robot), robot)
    reach.signed_distance(np.eye(4)[None])
    return reach


def read_reachability(path: Path, robot: str) -> ReachabilityField:
    """The field of ``robot`` from a file; errors as ``load_reachability``."""
    label = _label(robot)
    arrays, facts = read(path, label)
    try:
        levels = _unpacked(arrays["levels"].tobytes(), tuple(facts["shape"]))
        levels.flags.writeable = False
        numbers = {name: float(facts[name]) for name in _NUMBERS}
        origin, steps = np.array(facts["origin"]), np.array(facts["steps"])
        return ReachabilityField(robot, levels, origin, steps, hand=arrays["hand"], facts=facts, **numbers)
    except (KeyError, TypeError, ValueError, lzma.LZMAError) as error:
        raise label.refusal(path, error) from error


_NUMBERS = ("quantum_m", "theta_max_rad", "floor_margin_m", "shift_m")


def save_reachability(reach: ReachabilityField, path: Path | None = None) -> Path:
    """Write a field where ``load_reachability`` finds it, or to ``path``; all of it or nothing."""
    packed = np.frombuffer(_packed(reach.levels), dtype=np.uint8)
    facts = {
        **reach.facts,
        **{name: getattr(reach, name) for name in _NUMBERS},
        "shape": reach.levels.shape,
        "origin": reach.origin.tolist(),
        "steps": reach.steps.tolist(),
        "metres_per_radian": METRES_PER_RADIAN,
    }
    arrays: Arrays = {"levels": packed, "hand": reach.hand}
    return write(path or reachability_file(reach.robot), _label(reach.robot), arrays, facts)


def reachability_file(robot: str) -> Path:
    """Where the field of that robot is kept."""
    return ASSETS / "reachability" / f"{robot}.npz"


def _label(robot: str) -> Label:
    command = f"python -m backend build reachability --robot {robot}"
    return Label(f"reachability field of {robot}", FORMAT, command, {"robot": robot})


def _packed(levels: Levels) -> bytes:
    """Differences along roll and approach, which are mostly zero, compressed."""
    steps = levels.view(np.uint8)
    for axis in PACKED_AXES:
        steps = np.diff(steps, axis=axis, prepend=np.uint8(0))
    return lzma.compress(steps.tobytes(), format=lzma.FORMAT_XZ, preset=6)


def _unpacked(packed: bytes, shape: tuple[int, ...]) -> Levels:
    steps = np.frombuffer(lzma.decompress(packed), dtype=np.uint8).reshape(shape)
    for axis in reversed(PACKED_AXES):
        steps = np.cumsum(steps, axis=axis, dtype=np.uint8)
    return np.ascontiguousarray(steps).view(np.int8)
