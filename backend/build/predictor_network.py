"""The paper's network of motion prediction in torch (section IV-A), as it is trained."""

from __future__ import annotations

from typing import Any

import torch
from torch import Tensor, nn

from backend.knowledge.predictor import Layer, PredictorWeights
from backend.pipeline.predict.window import FEATURES, HORIZONS_S

HIDDEN = 100


class Network(nn.Module):
    """LSTM(100), 2 x Dense(100), Dense(horizons x 4)."""

    def __init__(self) -> None:
        super().__init__()
        self.lstm = nn.LSTM(FEATURES, HIDDEN, batch_first=True)
        self.dense = nn.ModuleList(
            [nn.Linear(HIDDEN, HIDDEN), nn.Linear(HIDDEN, HIDDEN), nn.Linear(HIDDEN, 4 * len(HORIZONS_S))]
        )

    def forward(self, tokens: Tensor, lengths: Tensor) -> Tensor:
        """Answers (b, horizons, 4) to tokens (b, bins, FEATURES) of which the first ``lengths`` (b,) are real."""
        return self.answer(self.remembered(tokens, lengths))

    def remembered(self, tokens: Tensor, lengths: Tensor) -> Tensor:
        """(b, HIDDEN) of the LSTM after the last real token."""
        out: Tensor = self.lstm(tokens)[0]
        return out[torch.arange(len(out)), lengths - 1]

    def answer(self, remembered: Tensor) -> Tensor:
        """(b, horizons, 4) from what ``remembered`` gives."""
        return _through(self.dense, remembered).view(-1, len(HORIZONS_S), 4)

    def fold_biases(self) -> None:
        """Put the LSTM's two biases into one, as they are kept: what is learnt on top of it knows no others."""
        biases = dict(self.lstm.named_parameters())
        with torch.no_grad():
            biases["bias_ih_l0"].add_(biases["bias_hh_l0"])
            biases["bias_hh_l0"].zero_()


class Spread(nn.Module):
    """Dense(100), Dense(horizons): the log of how far off an answer may be, in the answer's units."""

    def __init__(self) -> None:
        super().__init__()
        self.dense = nn.ModuleList([nn.Linear(HIDDEN, HIDDEN), nn.Linear(HIDDEN, len(HORIZONS_S))])

    def forward(self, remembered: Tensor) -> Tensor:
        """(b, horizons) from what the network has ``remembered``."""
        return _through(self.dense, remembered)


def exported(network: Network, spread: Spread, facts: dict[str, Any]) -> PredictorWeights:
    """The weights as plain arrays."""
    plain = {name: tensor.numpy().copy() for name, tensor in network.state_dict().items()}
    return PredictorWeights(
        lstm_in=plain["lstm.weight_ih_l0"],
        lstm_hidden=plain["lstm.weight_hh_l0"],
        lstm_bias=plain["lstm.bias_ih_l0"] + plain["lstm.bias_hh_l0"],
        dense=_layers(network.dense),
        spread=_layers(spread.dense),
        facts=facts,
    )


def _layers(dense: nn.ModuleList) -> tuple[Layer, ...]:
    kept = [layer.state_dict() for layer in dense]
    return tuple((layer["weight"].numpy().copy(), layer["bias"].numpy().copy()) for layer in kept)


def _through(dense: nn.ModuleList, x: Tensor) -> Tensor:
    for layer in dense[:-1]:
        x = torch.relu(layer(x))
    return dense[-1](x)
