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
from backend.build.motion_metrics import agreement, best_sharpness
from backend.build.motion_split import Split, SplitSettings, split
from backend.knowledge.motion_aware import Floats, Layer, MotionAwareModel, sigmoid
from backend.knowledge.motion_features import FEATURES, grasp_features, motion_features
from backend.robots import ROBOTS

OnProgress = Callable[[str], None]
HIDDEN = 512
LEAST_SCALE = 1e-3
CODE = ("build/motion_*.py", "knowledge/motion_*.py")


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
    dropout: float = 0.1
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
    twin = train(source, attempts, parts.training, parts.validation, on_progress, settings)
    everything = np.sort(np.concatenate([parts.training, parts.trials, parts.grasps]))
    model = train(source, attempts, everything, parts.validation, on_progress, settings)
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
    training: NDArray[np.int64],
    validation: NDArray[np.int64],
    on_progress: OnProgress,
    settings: TrainingSettings,
) -> MotionAwareModel:
    """A model from the rows ``training``; the rows ``validation`` choose its epoch and its temperature."""
    torch.set_num_threads(1)
    backoff_m = ROBOTS[source.robot].backoff_m
    features = _features(attempts, backoff_m)
    center = features[training].mean(axis=0)
    scale = np.maximum(features[training].std(axis=0), LEAST_SCALE)
    known = torch.from_numpy(((features - center) / scale).astype(np.float32))
    held = torch.from_numpy(attempts.held.astype(np.float32))
    learn, check = torch.from_numpy(training), torch.from_numpy(validation)
    network, epochs = _fitted((known[learn], held[learn]), (known[check], held[check]), source.seed, settings)
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
    checked = attempts.take(validation)
    sharpness = best_sharpness(_logits(model, checked), checked.held)
    model = sharpened(model, sharpness)
    model.facts["temperature"] = round(1.0 / sharpness, 4)
    loss = agreement(_probability(model, checked), checked.held).log_loss
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
    learn: tuple[Tensor, Tensor], check: tuple[Tensor, Tensor], seed: int, settings: TrainingSettings
) -> tuple[Network, int]:
    """The network of the epoch with the least validation loss, and that epoch's number."""
    with torch.random.fork_rng():
        torch.manual_seed(seed)
        network = Network(settings.dropout)
        optimizer = torch.optim.AdamW(
            network.parameters(), lr=settings.rate, weight_decay=settings.weight_decay, fused=False
        )
        best, best_loss, best_epoch = copy.deepcopy(network), math.inf, 0
        for epoch in range(settings.epochs):
            for group in optimizer.param_groups:
                group["lr"] = settings.rate * 0.5 * (1.0 + math.cos(math.pi * epoch / settings.epochs))
            _one_epoch(network, optimizer, learn, settings.batch)
            network.eval()
            with torch.no_grad():
                loss = float(nn.functional.binary_cross_entropy_with_logits(network(check[0]), check[1]))
            if loss < best_loss:
                best, best_loss, best_epoch = copy.deepcopy(network), loss, epoch + 1
            elif epoch + 1 - best_epoch >= settings.patience:
                break
    return best, best_epoch


def _one_epoch(network: Network, optimizer: torch.optim.AdamW, learn: tuple[Tensor, Tensor], batch: int) -> None:
    network.train()
    for rows in torch.randperm(len(learn[0])).split(batch):
        loss = nn.functional.binary_cross_entropy_with_logits(network(learn[0][rows]), learn[1][rows])
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()


def _features(attempts: Attempts, backoff_m: float) -> NDArray[np.float64]:
    grasps = grasp_features(attempts.Ts_object_grasp, backoff_m)
    return np.concatenate([grasps, motion_features(attempts.speed_mps, attempts.direction_rad)], axis=1)


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
