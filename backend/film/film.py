"""Film: which moments of a trial are shown, one picture after the other."""

from __future__ import annotations

from collections.abc import Iterator

from backend.film.caption import Caption
from backend.film.picture import Painter, Pixels
from backend.film.takes import Takes
from backend.scenario import Scenario
from backend.snapshot import Snapshot

LAST_S = 1.5
"""How long the outcome stays."""


def shown(takes: Takes, fps: float, speed: float) -> list[Snapshot]:
    """The snapshot of every picture: time passes ``speed`` times as fast as in the trial, and the last one stays."""
    snapshots, out = takes.snapshots, list[Snapshot]()
    i = 0
    while i < len(snapshots) - 1:
        if snapshots[i].t_s >= len(out) * speed / fps - 1e-9:
            out.append(snapshots[i])
        else:
            i += 1
    return [*out, *[snapshots[-1]] * round(LAST_S * fps)]


def pictures(takes: Takes, scenario: Scenario, moments: list[Snapshot], width: int, height: int) -> Iterator[Pixels]:
    """(height, width, 3) of each moment; a moment that stays is drawn once."""
    painter = Painter(takes.scene, takes.snapshots[0], width, height)
    caption = Caption(scenario, takes.scene.seed, height)
    last: tuple[Snapshot, Pixels] | None = None
    for moment in moments:
        if last is None or last[0] is not moment:
            last = (moment, caption.below(painter.paint(moment), moment))
        yield last[1]
