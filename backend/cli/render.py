"""``render``: a traced trial as a film."""

import argparse
import json
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from backend.cli.telling import Teller
from backend.errors import InvalidInputError
from backend.film.film import pictures, shown
from backend.film.takes import takes_of
from backend.film.writing import ENDINGS, write_film
from backend.record import load_trace

USUAL = {".gif": (640, 100 / 6), ".mp4": (960, 30.0)}
"""Width in pixels, and pictures a second; a GIF counts in hundredths of a second."""
WIDTHS = (160, 1920)
FASTEST = 30.0


def run(options: argparse.Namespace) -> int:
    """Always 0."""
    out = Path(options.out)
    if out.suffix.lower() not in ENDINGS:
        raise InvalidInputError(f"--out ends in {' or '.join(ENDINGS)} (got {options.out!r})")
    width, fps = USUAL[out.suffix.lower()]
    width = options.width or width
    if not WIDTHS[0] <= width <= WIDTHS[1]:
        raise InvalidInputError(f"--width is from {WIDTHS[0]} to {WIDTHS[1]} (got {width})")
    if not 0.1 <= options.speed <= FASTEST:
        raise InvalidInputError(f"--speed is from 0.1 to {FASTEST:g} (got {options.speed:g})")
    width, height = width // 2 * 2, width * 9 // 32 * 2
    begun_s = time.perf_counter()
    trace = load_trace(Path(options.trace))
    takes = takes_of(trace)
    moments = shown(takes, fps, options.speed)
    drawn = pictures(takes, trace.scenario, moments, width, height)
    write_film(out, _told(drawn, len(moments), options.json), fps)
    took_s = time.perf_counter() - begun_s
    seconds, size = len(moments) / fps, out.stat().st_size
    if options.json:
        print(json.dumps({"file": str(out), "seconds": seconds, "width": width, "height": height, "bytes": size}))
    else:
        print(f"{out}: {seconds:.1f} s, {width} x {height}, {size / 1e6:.1f} MB, in {took_s:.0f} s")
    return 0


def _told(drawn: Iterator[NDArray[np.uint8]], total: int, quiet: bool) -> Iterator[NDArray[np.uint8]]:
    """The same, with progress told."""
    tell = Teller()
    for i, picture in enumerate(drawn):
        if not quiet:
            tell(f"picture {i + 1} of {total}")
        yield picture
