"""One trial from start to end, without a screen."""

from collections.abc import Callable
from pathlib import Path

from backend.episode import Episode
from backend.record import TrialRecord
from backend.scenario import Scenario
from backend.snapshot import Snapshot


def run_trial(
    scenario: Scenario,
    seed: int | None = None,
    trace: Path | None = None,
    watch: Callable[[Snapshot], None] | None = None,
) -> TrialRecord:
    """Run a trial to its end, show every snapshot to ``watch``, and write its trace if asked."""
    with Episode(scenario, seed) as episode:
        if watch is None:
            episode.finish()
        else:
            for snapshot in episode.run():
                watch(snapshot)
        if trace is not None:
            episode.recorder.save_trace(trace)
        return episode.recorder.record()
