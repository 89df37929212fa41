"""The photograph network: statistics of windows in, one response for all of them out."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor, nn

from crfnet_core.emor import COMPONENTS
from training.network.features import (
    CANDIDATE_FEATURES,
    EDGE_FEATURES,
    EQUATION_FEATURES,
    LEVEL_FEATURES,
    Features,
)

#: Standard deviations to which normalised features are clipped: a photograph may be unlike all training photographs.
LARGEST_FEATURE = 6


@dataclass(frozen=True)
class NetworkConfig:
    """The sizes of the network and what training leaves out at random.

    Parameters
    ----------
    width : int
        Values of every hidden layer.
    dropout : float
        Fraction of the hidden values that are set to 0.
    kind_dropout : float
        Fraction of the rows in which a whole kind of features is set to 0.
    """

    width: int = 384
    dropout: float = 0.1
    kind_dropout: float = 0.15


class KindLayer(nn.Module):
    """One kind of features to a vector: normalisation, kind dropout in training, and a dense layer."""

    def __init__(self, features: int, config: NetworkConfig) -> None:
        super().__init__()
        self.kind_dropout = config.kind_dropout
        self.normalization = nn.BatchNorm1d(features, affine=False)
        self.dense = _dense(features, config)

    def forward(self, features: Tensor) -> Tensor:
        """Return vectors, shape (N, ..., width), of features (N, ..., F)."""
        normalized = self.normalization(features.flatten(0, -2)).reshape(features.shape)
        return self.dense(self.drop_kind(normalized.clamp(-LARGEST_FEATURE, LARGEST_FEATURE)))

    def drop_kind(self, features: Tensor) -> Tensor:
        """Return the features; in training, all of some rows are 0 so that the network relies on no kind alone."""
        if not self.training:
            return features
        row = (len(features), *[1] * (features.ndim - 1))
        return features * (torch.rand(row, device=features.device) >= self.kind_dropout)


class Embedding(nn.Module):
    """Statistics, of one window or summed over several, to a vector."""

    def __init__(self, config: NetworkConfig) -> None:
        super().__init__()
        self.features = Features()
        self.levels = KindLayer(LEVEL_FEATURES, config)
        self.edges = KindLayer(EDGE_FEATURES, config)
        self.equations = KindLayer(EQUATION_FEATURES, config)
        self.candidates = KindLayer(CANDIDATE_FEATURES, config)
        self.trunk = _dense(5 * config.width, config)

    def forward(self, statistics: Tensor) -> Tensor:
        """Return vectors, shape (N, width), of statistics (N, LENGTH).

        The three channels share a layer, and their vectors are pooled by mean and maximum: their order is no matter.
        """
        with torch.no_grad(), torch.autocast("cpu", enabled=False):
            levels, edges, equations, candidates = self.features(statistics)
        channels = self.levels(levels)  # (N, 3, width)
        kinds = [self.edges(edges), self.equations(equations), self.candidates(candidates)]
        return self.trunk(torch.cat([channels.mean(1), channels.amax(1), *kinds], dim=1))


class Head(nn.Module):
    """A vector to EMoR weights and the logarithm of the expected estimation error."""

    def __init__(self, inputs: int, config: NetworkConfig) -> None:
        super().__init__()
        self.trunk = _dense(inputs, config)
        self.weights = nn.Linear(config.width, COMPONENTS)
        self.log_error = nn.Linear(config.width, 1)

    def forward(self, vectors: Tensor) -> tuple[Tensor, Tensor]:
        """Return weights (N, 11) and log errors (N,)."""
        hidden = self.trunk(vectors)
        return self.weights(hidden), self.log_error(hidden).squeeze(1)


class PhotographNet(nn.Module):
    """Windows of photographs to EMoR weights and log expected errors, of each window and of each photograph.

    The pooling is learned (docs/METHOD.md, Eq. 17). The vector of a photograph has two parts: the mean of its windows'
    vectors, weighted by a score that each window earns, and the vector of the sum of its windows' statistics.
    """

    def __init__(self, config: NetworkConfig) -> None:
        super().__init__()
        self.embedding = Embedding(config)
        self.score = nn.Linear(config.width, 1)
        self.window = Head(config.width, config)
        self.photograph = Head(2 * config.width, config)

    def forward(self, statistics: Tensor, present: Tensor) -> tuple[Tensor, Tensor, Tensor, Tensor]:
        """Return window weights (B, K, 11), window log errors (B, K), weights (B, 11) and log errors (B,).

        Parameters
        ----------
        statistics : Tensor, shape (B, K, LENGTH)
            Of K windows of each of B photographs.
        present : Tensor, bool, shape (B, K)
            Which windows count; at least one of each photograph.
        """
        together = (statistics * present[..., None]).sum(1, keepdim=True)
        rows = torch.cat([statistics, together], dim=1)  # (B, K + 1, LENGTH)
        vectors = self.embedding(rows.flatten(0, 1)).unflatten(0, rows.shape[:2])
        windows, whole = vectors[:, :-1], vectors[:, -1]
        scores = self.score(windows).squeeze(-1).masked_fill(~present, -torch.inf)
        pooled = (scores.softmax(1)[..., None] * windows).sum(1)
        weights, log_errors = self.window(windows.flatten(0, 1))
        weights, log_errors = weights.unflatten(0, present.shape), log_errors.unflatten(0, present.shape)
        return weights, log_errors, *self.photograph(torch.cat([pooled, whole], dim=1))


class ShippedNetwork(nn.Module):
    """The network as it ships: the windows of one photograph, or of several photographs of one camera, as one set."""

    def __init__(self, net: PhotographNet) -> None:
        super().__init__()
        self.net = net

    def forward(self, statistics: Tensor) -> tuple[Tensor, Tensor, Tensor, Tensor]:
        """Return weights (N, 11), log errors (N,), pooled ones (1, 11) and (1,), of statistics (N, LENGTH)."""
        present = torch.ones(1, statistics.shape[0], dtype=torch.bool)
        weights, log_errors, pooled, pooled_log_error = self.net(statistics[None], present)
        return weights[0], log_errors[0], pooled, pooled_log_error


def _dense(inputs: int, config: NetworkConfig) -> nn.Sequential:
    """Return a layer from `inputs` values to the network's width."""
    return nn.Sequential(nn.Linear(inputs, config.width), nn.GELU(), nn.Dropout(config.dropout))
