"""Writing: pictures into a GIF (Pillow) or an MP4 (ffmpeg's H.264, from the package imageio-ffmpeg)."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import imageio_ffmpeg
import numpy as np
from PIL import Image

from backend.errors import InvalidInputError
from backend.files import replacing
from backend.film.picture import Pixels

ENDINGS = (".gif", ".mp4")
COLORS = 255
SAMPLES = 6
"""Pictures that the colours of a GIF are chosen from."""
_ffmpeg: Any = imageio_ffmpeg


def write_film(path: Path, pictures: Iterable[Pixels], fps: float) -> None:
    """The pictures, all of one size with even sides, as a film that is there whole or not at all.

    Raises ``InvalidInputError`` for another ending, or when it can't be written.
    """
    if path.suffix.lower() not in ENDINGS:
        raise InvalidInputError(f"A film ends in {' or '.join(ENDINGS)}, not in {path.suffix!r} (got {path}).")
    try:
        if path.suffix.lower() == ".gif":
            _write_gif(path, list(pictures), fps)
        else:
            _write_mp4(path, pictures, fps)
    except OSError as error:
        raise InvalidInputError(f"Cannot write the film to {path}: {error.strerror or error}.") from error


def _write_gif(path: Path, pictures: list[Pixels], fps: float) -> None:
    """One set of colours for the whole film, so that nothing flickers; only what has moved is kept of a picture."""
    chosen = np.concatenate([pictures[i] for i in np.linspace(0, len(pictures) - 1, SAMPLES).astype(int)])
    palette = Image.fromarray(chosen).quantize(COLORS, Image.Quantize.MEDIANCUT)
    frames = [Image.fromarray(picture).quantize(palette=palette, dither=Image.Dither.NONE) for picture in pictures]
    with replacing(path) as file:
        frames[0].save(
            file, "GIF", save_all=True, append_images=frames[1:], duration=round(1000 / fps), loop=0, optimize=False
        )


def _write_mp4(path: Path, pictures: Iterable[Pixels], fps: float) -> None:
    with tempfile.TemporaryDirectory() as folder:
        aside = Path(folder) / "film.mp4"
        writer: Any = None
        for picture in pictures:
            if writer is None:
                height, width, _ = picture.shape
                writer = _ffmpeg.write_frames(
                    str(aside),
                    (width, height),
                    fps=fps,
                    codec="libx264",
                    quality=None,
                    macro_block_size=2,
                    ffmpeg_log_level="error",
                    output_params=["-crf", "20", "-preset", "veryfast", "-movflags", "+faststart"],
                )
                writer.send(None)
            writer.send(np.ascontiguousarray(picture))
        if writer is not None:
            writer.close()
        with replacing(path) as file, aside.open("rb") as made:
            shutil.copyfileobj(made, file)
