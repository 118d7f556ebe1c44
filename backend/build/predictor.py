"""Trains the network of motion prediction, and then what says how far off it may be."""

from __future__ import annotations

import hashlib
import math
import zipfile
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from importlib.metadata import version
from pathlib import Path
from pickle import UnpicklingError
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn

from backend.build.digests import code_digest
from backend.build.predictor_network import HIDDEN, Network, exported
from backend.build.predictor_spread import SpreadSettings, learn_spread
from backend.build.sequences import Sequences, SequenceSettings, draw_sequences
from backend.files import replacing
from backend.knowledge.predictor import PredictorWeights
from backend.pipeline.predict.window import BINS_S, FEATURES, HORIZONS_S, MIN_BINS, Windows, normalised

OnProgress = Callable[[str], None]
TRAINING, VALIDATION = 0, 1
CODE = ("build/predictor*.py", "build/sequences.py", "pipeline/predict/window.py")


@dataclass(frozen=True)
class PredictorSettings:
    """How much training, and on what."""

    steps: int = 12_000
    batch: int = 320
    """New sequences drawn for every step; none is seen twice."""
    rate: float = 3e-3
    """Adam's, falling to zero along half a cosine after a short rise."""
    average: float = 0.998
    """Decay of the running mean of the weights, which is what is kept."""
    validation: int = 4000
    checkpoint_every: int = 250
    report_every: int = 250
    sequences: SequenceSettings = field(default_factory=SequenceSettings)
    spread: SpreadSettings = field(default_factory=SpreadSettings)


@dataclass(eq=False)
class _Run:
    """Everything a checkpoint holds."""

    network: Network
    mean: Network
    optimizer: torch.optim.Adam
    step: int = 0


def build_predictor(
    seed: int, checkpoint: Path, on_progress: OnProgress, settings: PredictorSettings | None = None
) -> PredictorWeights:
    """Train from ``checkpoint`` if it is one of this very training, else from nothing; the file is kept up to date.

    Same arguments, same weights on the same machine, however often it was killed in between.
    """
    settings = settings or PredictorSettings()
    torch.set_num_threads(1)
    run = _begin(seed, settings)
    _resume(run, checkpoint, _purpose(seed, settings), on_progress)
    validation = draw_sequences(settings.validation, np.random.default_rng([seed, VALIDATION]), settings.sequences)
    losses: list[float] = []
    while run.step < settings.steps:
        losses.append(_train_one(run, seed, settings))
        if run.step % settings.checkpoint_every == 0 or run.step == settings.steps:
            _save(run, checkpoint, _purpose(seed, settings))
        if run.step % settings.report_every == 0:
            on_progress(f"step {run.step} of {settings.steps}, loss {np.mean(losses):.4f}")
            losses = []
    on_progress("learning how far off it may be")
    spread, within = learn_spread(run.mean, seed, settings.spread, settings.sequences)
    facts = {
        "seed": seed,
        "source": source_digest(seed, settings),
        "settings": asdict(settings),
        "sequences": settings.steps * settings.batch,
        "torch": version("torch"),
        "numpy": version("numpy"),
        "validation": _measured(run.mean, validation),
        "spread": within,
    }
    return exported(run.mean, spread, facts)


def is_up_to_date(weights: PredictorWeights, seed: int, settings: PredictorSettings | None = None) -> bool:
    """Whether ``build_predictor`` would make these very weights."""
    return weights.facts.get("source") == source_digest(seed, settings or PredictorSettings())


def source_digest(seed: int, settings: PredictorSettings) -> str:
    """Of everything that decides the weights: seed, settings, code, torch."""
    return hashlib.sha256(f"{_purpose(seed, settings)} {code_digest(CODE)}".encode()).hexdigest()[:16]


def _begin(seed: int, settings: PredictorSettings) -> _Run:
    with torch.random.fork_rng():
        torch.manual_seed(seed)
        network, mean = Network(), Network()
    mean.load_state_dict(network.state_dict())
    return _Run(network, mean, torch.optim.Adam(network.parameters(), lr=settings.rate))


def _train_one(run: _Run, seed: int, settings: PredictorSettings) -> float:
    rng = np.random.default_rng([seed, TRAINING, run.step])
    share = run.step / settings.steps
    for group in run.optimizer.param_groups:
        group["lr"] = settings.rate * min(1.0, 50.0 * share + 0.01) * 0.5 * (1.0 + math.cos(math.pi * share))
    tokens, lengths, target, worth = _batch(draw_sequences(settings.batch, rng, settings.sequences))
    loss = _loss(run.network(tokens, lengths), target, worth)
    run.optimizer.zero_grad()
    loss.backward()
    nn.utils.clip_grad_norm_(run.network.parameters(), 1.0)
    run.optimizer.step()
    decay = min(settings.average, (1 + run.step) / (10 + run.step))
    with torch.no_grad():
        for mean, now in zip(run.mean.parameters(), run.network.parameters(), strict=True):
            mean.lerp_(now, 1.0 - decay)
    run.step += 1
    return float(loss.detach())


def _batch(drawn: Sequences) -> tuple[Tensor, Tensor, Tensor, Tensor]:
    """Tokens, lengths, what the network should answer, and (b, 2) how much position and yaw count.

    What is far off its line counts more, by the square root: half-way from relative to absolute errors.
    """
    windows = normalised(drawn.age_s, drawn.states, drawn.seen)
    off = drawn.future - windows.states(np.zeros_like(drawn.future))
    answer = (off @ windows.turn) / np.maximum(windows.scale, 1e-12)
    counts = (windows.scale[:, 0, 2:] > 1e-7) & (windows.lengths >= MIN_BINS)[:, None]
    answer = np.where(counts[:, None, [0, 0, 0, 1]], answer, 0.0)
    worth = counts * np.sqrt(np.clip(windows.scale[:, 0, 2:] / (1e-3, 1.0), 0.04, 25.0))
    return (
        torch.from_numpy(windows.tokens),
        torch.from_numpy(windows.lengths),
        torch.from_numpy(answer.astype(np.float32)),
        torch.from_numpy(worth.astype(np.float32)),
    )


def _loss(answer: Tensor, target: Tensor, worth: Tensor) -> Tensor:
    """Mean distance of the positions, which forgives what nobody could foresee, and of the yaws a little."""
    off = answer - target
    distance = torch.sqrt((off[..., :3] ** 2).sum(dim=2) + 1e-6).mean(dim=1)
    yaw = torch.sqrt(off[..., 3] ** 2 + 1e-6).mean(dim=1)
    return (worth[:, 0] * distance + worth[:, 1] * yaw).sum() / len(worth)


def _measured(network: Network, drawn: Sequences) -> dict[str, Any]:
    """Mean error in mm at 0.5, 1 and 2 s on sequences never trained on, beside the straight line's."""
    windows = normalised(drawn.age_s, drawn.states, drawn.seen)
    with torch.no_grad():
        answer = network(torch.from_numpy(windows.tokens), torch.from_numpy(windows.lengths)).double().numpy()
    at = np.searchsorted(HORIZONS_S, [0.5, 1.0, 2.0])
    return {
        "sha256": hashlib.sha256(drawn.states.tobytes()).hexdigest(),
        "lstm_mm": _error_mm(windows, answer, drawn)[at].round(3).tolist(),
        "line_mm": _error_mm(windows, np.zeros_like(answer), drawn)[at].round(3).tolist(),
    }


def _error_mm(windows: Windows, answer: Any, drawn: Sequences) -> Any:
    known = windows.lengths >= MIN_BINS
    off = (windows.states(answer) - drawn.future)[known, :, :3]
    return 1e3 * np.linalg.norm(off, axis=2).mean(axis=0)


def _purpose(seed: int, settings: PredictorSettings) -> str:
    """What tells one training from another."""
    parts = [seed, asdict(settings), BINS_S.tolist(), HORIZONS_S.tolist(), FEATURES, HIDDEN, version("torch")]
    return repr(parts)


def _save(run: _Run, path: Path, purpose: str) -> None:
    state = {
        "purpose": purpose,
        "step": run.step,
        "network": run.network.state_dict(),
        "mean": run.mean.state_dict(),
        "optimizer": run.optimizer.state_dict(),
    }
    with replacing(path) as file:
        torch.save(state, file)


def _resume(run: _Run, path: Path, purpose: str, on_progress: OnProgress) -> None:
    if not path.is_file():
        return
    try:
        state = torch.load(path, weights_only=True)
    except (RuntimeError, OSError, EOFError, UnpicklingError, zipfile.BadZipFile):
        on_progress(f"{path} cannot be read; beginning anew")
        return
    if not isinstance(state, dict) or state.get("purpose") != purpose:
        on_progress(f"{path} is of another training; beginning anew")
        return
    run.network.load_state_dict(state["network"])
    run.mean.load_state_dict(state["mean"])
    run.optimizer.load_state_dict(state["optimizer"])
    run.step = int(state["step"])
    on_progress(f"going on at step {run.step}")
