"""Caption: what is going on, and when, below every picture."""

from __future__ import annotations

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from backend.film.picture import Pixels
from backend.methods import METHODS
from backend.pipeline.values import Phase
from backend.robots import ROBOTS
from backend.robots.looks import Rgb
from backend.scenario import Scenario
from backend.snapshot import Snapshot
from backend.tasks import TASKS

PHASES: dict[Phase, tuple[str, Rgb]] = {
    "watch": ("Watching", (100, 108, 117)),
    "move": ("Moving to pregrasp", (28, 126, 214)),
    "approach": ("Approaching", (230, 119, 0)),
    "close": ("Closing hand", (214, 51, 108)),
    "lift": ("Lifting", (43, 138, 62)),
    "hold": ("Holding", (43, 138, 62)),
    "done": ("Finished", (43, 138, 62)),
}
GOOD: Rgb = (43, 138, 62)
BAD: Rgb = (201, 42, 42)
TEXT: Rgb = (33, 37, 41)
QUIET: Rgb = (100, 108, 117)
BAND: Rgb = (255, 255, 255)
BAND_SHARE, TEXT_SHARE = 0.1, 0.04
"""Of the picture's height."""


class Caption:
    """Of one film: what it is of does not change."""

    def __init__(self, scenario: Scenario, seed: int, height: int) -> None:
        names = (
            TASKS[scenario.task.kind].title,
            scenario.object.replace("_", " "),
            METHODS[scenario.method.name].title,
        )
        self._facts = ", ".join((ROBOTS[scenario.robot].title, *names, f"seed {seed}"))
        self._band = round(BAND_SHARE * height)
        self._font = ImageFont.load_default(max(round(TEXT_SHARE * height), 10))
        self._small = ImageFont.load_default(max(round(0.8 * TEXT_SHARE * height), 9))

    def below(self, picture: Pixels, snapshot: Snapshot) -> Pixels:
        """The picture with its caption."""
        image = Image.fromarray(picture)
        draw = ImageDraw.Draw(image)
        width, height = image.size
        band = self._band
        middle, margin = height - band / 2, band * 0.3
        draw.rectangle((0, height - band, width, height), fill=BAND)
        words, color = words_of(snapshot)
        right = margin + draw.textlength(words, self._font) + 2 * margin
        draw.rounded_rectangle((margin, height - 0.82 * band, right, height - 0.18 * band), band * 0.2, fill=color)
        draw.text((2 * margin, middle), words, BAND, self._font, anchor="lm")
        clock = f"{snapshot.t_s:.1f} s"
        draw.text((right + margin, middle), clock, TEXT, self._font, anchor="lm")
        room = width - right - 3 * margin - draw.textlength("88.8 s", self._font)
        draw.text((width - margin, middle), self._fitting(draw, room), QUIET, self._small, anchor="rm")
        return np.asarray(image)

    def _fitting(self, draw: ImageDraw.ImageDraw, room_px: float) -> str:
        """As many of the facts as there is room for, whole ones."""
        text = self._facts
        while text and draw.textlength(text, self._small) > room_px:
            text = text.rpartition(", ")[0]
        return text


def words_of(snapshot: Snapshot) -> tuple[str, Rgb]:
    """What is going on, and its colour."""
    outcome = snapshot.outcome
    if outcome is None:
        return PHASES[snapshot.phase]
    if outcome.strict:
        return "Grasped", GOOD
    return f"Not grasped: {(outcome.reason or 'error').replace('_', ' ')}", BAD
