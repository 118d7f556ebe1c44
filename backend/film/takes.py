"""Takes: the course of a traced trial, run again, since a trace itself keeps no fingers, phases and obstacles."""

from __future__ import annotations

from dataclasses import dataclass

from backend.episode import Episode
from backend.errors import InvalidInputError
from backend.record import Trace
from backend.snapshot import SceneDescription, Snapshot


@dataclass(frozen=True, eq=False)
class Takes:
    """One trial from start to end."""

    scene: SceneDescription
    snapshots: tuple[Snapshot, ...]
    """At least two; the last has the outcome."""


def takes_of(trace: Trace) -> Takes:
    """Raises ``InvalidInputError`` when the trial comes out otherwise than it was traced."""
    with Episode(trace.scenario) as episode:
        scene, snapshots = episode.scene, tuple(episode.run())
    recorded = trace.record["fingerprint"]
    if snapshots[-1].fingerprint != recorded:
        raise InvalidInputError(
            f"With this code the trial comes out otherwise than it was traced (fingerprint {snapshots[-1].fingerprint} "
            f"instead of {recorded}), so a film would show another trial. Trace it again: "
            "python -m backend trial SCENARIO --trace FILE."
        )
    return Takes(scene, snapshots)
