"""Trains the motion-aware network: the paper's two hidden layers of 512, and a probability that means what it says."""

from __future__ import annotations

import copy
import hashlib
import math
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from importlib.metadata import version
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from backend.build.attempts import Attempts
from backend.build.digests import code_digest
from backend.build.motion_curves import curves
from backend.build.motion_data import Source
from backend.build.motion_images import images
from backend.build.motion_metrics import agreement, best_sharpness
from backend.build.motion_split import Split, SplitSettings, split
from backend.build.symmetries import Symmetries, symmetries
from backend.knowledge.motion_aware import Floats, Layer, MotionAwareModel, sigmoid
from backend.knowledge.motion_features import FEATURES, grasp_features, motion_features
from backend.objects import load_object
from backend.pose import Array
from backend.robots import ROBOTS

OnProgress = Callable[[str], None]
HIDDEN = 512
LEAST_SCALE = 1e-3
CODE = (
    *(f"build/motion_{name}.py" for name in ("aware", "curves", "data", "images", "metrics", "split")),
    *("build/object_field.py", "build/symmetries.py", "knowledge/motion_*.py"),
)


@dataclass(frozen=True)
class TrainingSettings:
    """How a network is trained."""

    epochs: int = 100
    """At most; the paper's."""
    patience: int = 15
    """Epochs without a better validation loss, after which it ends."""
    batch: int = 128
    rate: float = 1e-3
    """AdamW's, falling to zero along half a cosine over all epochs."""
    weight_decay: float = 1e-2
    dropout: float = 0.05
    average: float = 0.998
    """Decay of the running mean of the weights, which is what is kept."""
    believed_anew: float = 0.5
    """Share of the attempts shown as if the object had been believed elsewhere, as far from where it truly was."""
    split: SplitSettings = field(default_factory=SplitSettings)


class Network(nn.Module):
    """Log odds (b,) of normalised features (b, FEATURES)."""

    def __init__(self, dropout: float = 0.0) -> None:
        super().__init__()
        self.layers = nn.ModuleList([nn.Linear(FEATURES, HIDDEN), nn.Linear(HIDDEN, HIDDEN), nn.Linear(HIDDEN, 1)])
        self.dropout = nn.Dropout(dropout)

    def forward(self, features: Tensor) -> Tensor:
        x = torch.relu(self.layers[0](features))
        x = torch.relu(self.layers[1](self.dropout(x)))
        return self.layers[2](self.dropout(x))[:, 0]


def build_motion_aware(
    source: Source, attempts: Attempts, on_progress: OnProgress, settings: TrainingSettings | None = None
) -> MotionAwareModel:
    """The model of one hand and object, from its attempts. Same arguments, same weights on the same machine.

    A twin is trained without the test parts and measured on them; its figures are in ``facts``. The model itself then
    learns from the test parts too, since grasps kept from it would be ranked by guesswork in every trial.
    """
    settings = settings or TrainingSettings()
    begun_s = time.perf_counter()
    parts = split(attempts.grasp, source.seed, settings.split)
    alike = symmetries(load_object(source.object))
    twin = train(source, attempts, alike, parts.training, parts.validation, on_progress, settings)
    everything = np.sort(np.concatenate([parts.training, parts.trials, parts.grasps]))
    model = train(source, attempts, alike, everything, parts.validation, on_progress, settings)
    facts: dict[str, Any] = {
        "seed": source.seed,
        "attempts": len(attempts),
        "source": source.digest(),
        "training": training_digest(settings),
        "settings": {"attempts": asdict(source.settings), "training": asdict(settings)},
        "versions": {name: version(name) for name in ("numpy", "torch", "pybullet", "dynamic-grasping")},
        "measured": _measured(twin, attempts, parts),
        "curves": _curves(twin, attempts, parts, source.settings.speeds_mps),
        "ends": dict(Counter(attempts.why.tolist()).most_common()),
        "took_s": round(time.perf_counter() - begun_s, 1),
    }
    model.facts.update(facts)
    return model


def is_up_to_date(
    model: MotionAwareModel, source: Source, attempts: int, settings: TrainingSettings | None = None
) -> bool:
    """Whether ``build_motion_aware`` would make this very model of that many attempts."""
    wanted = {"source": source.digest(), "attempts": attempts, "training": training_digest(settings)}
    return wanted.items() <= model.facts.items()


def training_digest(settings: TrainingSettings | None = None) -> str:
    """Of everything that decides what is learnt from given attempts: settings, code, torch."""
    words = (asdict(settings or TrainingSettings()), version("torch"), code_digest(CODE))
    return hashlib.sha256(repr(words).encode()).hexdigest()[:16]


def train(
    source: Source,
    attempts: Attempts,
    alike: Symmetries,
    training: NDArray[np.int64],
    validation: NDArray[np.int64],
    on_progress: OnProgress,
    settings: TrainingSettings,
) -> MotionAwareModel:
    """A model from images of the rows ``training``; the rows ``validation`` choose its epoch and its temperature."""
    torch.set_num_threads(1)
    backoff_m = ROBOTS[source.robot].backoff_m
    learn, check = attempts.take(training), attempts.take(validation)
    features = _features(learn.Ts_object_grasp, learn.speed_mps, learn.direction_rad, backoff_m)
    center = features.mean(axis=0)
    scale = np.maximum(features.std(axis=0), LEAST_SCALE)

    def known(Ts: Array, speed_mps: Array, direction_rad: Array) -> Tensor:
        shown = _features(Ts, speed_mps, direction_rad, backoff_m)
        return torch.from_numpy(((shown - center) / scale).astype(np.float32))

    def fresh(rng: np.random.Generator) -> Tensor:
        Ts, direction_rad = images(learn, alike, source.settings, settings.believed_anew, rng)
        return known(Ts, learn.speed_mps, direction_rad)

    checked = known(check.Ts_object_grasp, check.speed_mps, check.direction_rad), _outcomes(check)
    network, epochs = _fitted(fresh, _outcomes(learn), checked, source.seed, settings)
    model = MotionAwareModel(
        source.robot,
        source.object,
        backoff_m,
        source.settings.speeds_mps,
        center.astype(np.float32),
        scale.astype(np.float32),
        exported(network),
        {"epochs": epochs},
    )
    sharpness = best_sharpness(_logits(model, check), check.held)
    model = sharpened(model, sharpness)
    model.facts["temperature"] = round(1.0 / sharpness, 4)
    loss = agreement(_probability(model, check), check.held).log_loss
    on_progress(f"{len(training)} attempts learnt in {epochs} epochs, validation log loss {loss:.4f}")
    return model


def exported(network: Network) -> tuple[Layer, Layer, Layer]:
    """The layers as plain arrays, weights as exact as the file keeps them."""
    plain = {name: tensor.numpy().copy() for name, tensor in network.state_dict().items()}

    def layer(k: int) -> Layer:
        return plain[f"layers.{k}.weight"].astype(np.float16).astype(np.float32), plain[f"layers.{k}.bias"]

    return layer(0), layer(1), layer(2)


def sharpened(model: MotionAwareModel, factor: float) -> MotionAwareModel:
    """The same model with all its log odds times ``factor``."""
    first, second, (weight, bias) = model.layers
    last: tuple[Floats, Floats] = (
        (weight * np.float32(factor)).astype(np.float16).astype(np.float32),
        bias * np.float32(factor),
    )
    return MotionAwareModel(
        model.robot,
        model.object,
        model.backoff_m,
        model.speeds_mps,
        model.center,
        model.scale,
        (first, second, last),
        model.facts,
    )


def _fitted(
    fresh: Callable[[np.random.Generator], Tensor],
    outcomes: Tensor,
    check: tuple[Tensor, Tensor],
    seed: int,
    settings: TrainingSettings,
) -> tuple[Network, int]:
    """The mean network of the epoch with the least validation loss, and that epoch's number."""
    rng = np.random.default_rng(seed)
    with torch.random.fork_rng():
        torch.manual_seed(seed)
        network = Network(settings.dropout)
        mean = copy.deepcopy(network).eval()
        optimizer = torch.optim.AdamW(
            network.parameters(), lr=settings.rate, weight_decay=settings.weight_decay, fused=False
        )
        best, best_loss, best_epoch, step = copy.deepcopy(mean), math.inf, 0, 0
        for epoch in range(settings.epochs):
            for group in optimizer.param_groups:
                group["lr"] = settings.rate * 0.5 * (1.0 + math.cos(math.pi * epoch / settings.epochs))
            step = _one_epoch(network, mean, optimizer, (fresh(rng), outcomes), step, settings)
            with torch.no_grad():
                loss = float(nn.functional.binary_cross_entropy_with_logits(mean(check[0]), check[1]))
            if loss < best_loss:
                best, best_loss, best_epoch = copy.deepcopy(mean), loss, epoch + 1
            elif epoch + 1 - best_epoch >= settings.patience:
                break
    return best, best_epoch


def _one_epoch(
    network: Network,
    mean: Network,
    optimizer: torch.optim.AdamW,
    learn: tuple[Tensor, Tensor],
    step: int,
    settings: TrainingSettings,
) -> int:
    """Steps done until now, of which ``step`` in other epochs."""
    for rows in torch.randperm(len(learn[0])).split(settings.batch):
        loss = nn.functional.binary_cross_entropy_with_logits(network(learn[0][rows]), learn[1][rows])
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        average = min(settings.average, (1 + step) / (10 + step))
        with torch.no_grad():
            for kept, now in zip(mean.parameters(), network.parameters(), strict=True):
                kept.lerp_(now, 1.0 - average)
        step += 1
    return step


def _outcomes(attempts: Attempts) -> Tensor:
    return torch.from_numpy(attempts.held.astype(np.float32))


def _features(Ts: Array, speed_mps: Array, direction_rad: Array, backoff_m: float) -> NDArray[np.float64]:
    return np.concatenate([grasp_features(Ts, backoff_m), motion_features(speed_mps, direction_rad)], axis=1)


def _logits(model: MotionAwareModel, attempts: Attempts) -> NDArray[np.float64]:
    return model.logits(attempts.Ts_object_grasp, attempts.speed_mps, attempts.direction_rad)


def _probability(model: MotionAwareModel, attempts: Attempts) -> NDArray[np.float64]:
    return sigmoid(_logits(model, attempts))


def _measured(model: MotionAwareModel, attempts: Attempts, parts: Split) -> dict[str, Any]:
    """Agreement on either test part, and on those attempts in it whose grasp is just as in the database."""
    measured: dict[str, Any] = {}
    for name, rows in (("trials", parts.trials), ("grasps", parts.grasps)):
        tested = attempts.take(rows)
        probability = _probability(model, tested)
        measured[name] = asdict(agreement(probability, tested.held))
        as_it_is = tested.variant == 0
        if as_it_is.any():
            measured[f"{name}_as_in_database"] = asdict(agreement(probability[as_it_is], tested.held[as_it_is]))
    return measured


def _curves(model: MotionAwareModel, attempts: Attempts, parts: Split, speeds_mps: tuple[float, float]) -> Any:
    tested = attempts.take(np.concatenate([parts.trials, parts.grasps]))
    return curves(tested, _probability(model, tested), speeds_mps)
