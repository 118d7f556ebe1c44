"""LiveEpisode: an episode as the page's simulation process runs it."""

from __future__ import annotations

import tempfile
from pathlib import Path

from app.engine import Keepsake
from backend.episode import Episode
from backend.errors import InvalidInputError
from backend.events import AddObstacle, MoveObstacle, RemoveObstacle
from backend.scenario import Scenario


class LiveEpisode(Episode):
    """Refuses edits that cannot come to pass before it begins, and leaves something to take home."""

    def __init__(self, scenario: Scenario, seed: int) -> None:
        """Raises ``InvalidInputError`` for an edit of an obstacle that is not there."""
        super().__init__(scenario, seed)
        there = len(self.scene.obstacles)
        for timed in sorted(scenario.events, key=lambda timed: timed.tick):
            match timed.event:
                case MoveObstacle(index=index) | RemoveObstacle(index=index) if index >= there:
                    self.close()
                    does = "moves" if isinstance(timed.event, MoveObstacle) else "removes"
                    raise InvalidInputError(
                        f"events: tick {timed.tick} {does} obstacle {index}, but this trial has {there} then."
                    )
                case AddObstacle():
                    there += 1
                case RemoveObstacle():
                    there -= 1
                case _:
                    pass

    def keepsake(self) -> Keepsake:
        """Only of an episode that has ended."""
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "trial.npz"
            self.recorder.save_trace(path)
            return Keepsake(self.recorder.record().as_dict(), path.read_bytes())
