"""What a worker does: run one job and make a row of it."""

from __future__ import annotations

import hashlib
import math
import time
from dataclasses import asdict
from datetime import UTC, datetime

import numpy as np

from backend.episode import Episode
from backend.experiments.grid.cells import Job
from backend.experiments.grid.code import code_version
from backend.experiments.grid.row import GridRow
from backend.machine import machine
from backend.motions import CircularMotion, LinearMotion, Motion
from backend.snapshot import Snapshot


def run_job(job: Job, settings: str) -> GridRow:
    """Run a trial to its end; ``settings`` is the grid's hash."""
    begun_s = time.perf_counter()
    with Episode(job.scenario, job.seed) as episode:
        start = _start_hash(next(episode.run()))
        motion = episode.setup.motion
        episode.finish()
        record = episode.recorder.record()
    return GridRow(
        settings=settings,
        **asdict(job.key),
        seed=job.seed,
        strict=record.strict,
        authors=record.authors,
        reason=record.reason,
        detail=record.detail,
        approach_start_s=record.approach_start_s,
        lift_end_s=record.lift_end_s,
        end_s=record.end_s,
        cycles=record.cycles,
        cycle_mean_ms=record.cycle_mean_ms,
        cycle_p95_ms=record.cycle_p95_ms,
        joint_path_rad=record.joint_path_rad,
        distance_m=distance_m(motion),
        speed_mps=mean_speed_mps(motion),
        start=start,
        fingerprint=record.fingerprint,
        wall_s=time.perf_counter() - begun_s,
        attempts=1,
        code=code_version(),
        machine=machine(),
        finished=now(),
    )


def now() -> str:
    """UTC, to the second."""
    return datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%SZ")


def distance_m(motion: Motion) -> float:
    """Least level distance of the belt from the robot's base; of a sinusoid, that of its axis (r in the paper)."""
    if isinstance(motion, CircularMotion):
        x, y, _ = motion.path_world(721).T
        return float(np.hypot(x, y).min())
    (x0, y0, _), (x1, y1, _) = motion.start_m, motion.end_m
    dx, dy = x1 - x0, y1 - y0
    share = min(max(-(x0 * dx + y0 * dy) / (dx * dx + dy * dy), 0.0), 1.0)
    return math.hypot(x0 + share * dx, y0 + share * dy)


def mean_speed_mps(motion: Motion) -> float:
    """Of the belt, averaged over time; of a sinusoid, along its axis."""
    if isinstance(motion, LinearMotion):
        return 0.5 * (motion.start_speed_mps + motion.end_speed_mps)
    return motion.speed_mps


def _start_hash(snapshot: Snapshot) -> str:
    """16 hexadecimal digits of where everything is before the belt starts."""
    digest = hashlib.sha256(snapshot.q.tobytes())
    for part in (snapshot.T_world_tray.matrix, snapshot.T_world_object.matrix, snapshot.Ts_world_obstacle):
        digest.update(part.tobytes())
    return digest.hexdigest()[:16]
