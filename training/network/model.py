"""The photograph network: statistics of windows in, evidence about the response out."""

from dataclasses import dataclass

import torch
from torch import Tensor, nn

from crfnet_core.posterior import UNUSUAL
from crfnet_core.posterior.evidence import EVIDENCE_WEIGHTS
from training.network.features import CANDIDATE_FEATURES, EDGE_FEATURES, EQUATION_FEATURES, LEVEL_FEATURES, features_of

#: Standard deviations to which normalized features are clipped: a photograph may be unlike all training photographs.
LARGEST_FEATURE = 6

#: Units of the first EMoR weights, about their standard deviations over the training responses.
WEIGHT_UNITS = (3.0, 1.2, 0.7, 0.4, 0.25)

#: Bound of the factor of a precision before its diagonal is made positive, which bounds it to 55 per unit.
LARGEST_RAW = 4.0

#: Evidence of N windows or photographs: locations (N, 5), factors of the precision (N, 5, 5), log-odds (N, 3).
EvidenceTensors = tuple[Tensor, Tensor, Tensor]


@dataclass(frozen=True)
class NetworkConfig:
    """The sizes of the network and what training leaves out at random."""

    width: int = 384  # values of every hidden layer
    dropout: float = 0.1  # fraction of the hidden values that are set to 0
    kind_dropout: float = 0.15  # fraction of the rows in which a whole kind of features is set to 0


class KindLayer(nn.Module):
    """One kind of features to a vector: normalization, kind dropout in training, and a dense layer."""

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
        self.levels = KindLayer(LEVEL_FEATURES, config)
        self.edges = KindLayer(EDGE_FEATURES, config)
        self.equations = KindLayer(EQUATION_FEATURES, config)
        self.candidates = KindLayer(CANDIDATE_FEATURES, config)
        self.trunk = _dense(5 * config.width, config)

    def forward(self, statistics: Tensor) -> Tensor:
        """Return vectors, shape (N, width), of statistics (N, LENGTH).

        The three channels share a layer, and their vectors are pooled by mean and maximum: their order does not matter.
        """
        with torch.no_grad(), torch.autocast("cpu", enabled=False):
            levels, edges, equations, candidates = features_of(statistics)
        channels = self.levels(levels)  # (N, 3, width)
        kinds = [self.edges(edges), self.equations(equations), self.candidates(candidates)]
        return self.trunk(torch.cat([channels.mean(1), channels.amax(1), *kinds], dim=1))


class Head(nn.Module):
    """A vector to evidence: a Student's t in the first EMoR weights, and log-odds of families (docs/METHOD.md, Eq. 18).

    The location is stated in `WEIGHT_UNITS`; the factor of the precision is lower triangular with a positive diagonal.
    """

    def __init__(self, inputs: int, config: NetworkConfig) -> None:
        super().__init__()
        self.trunk = _dense(inputs, config)
        self.location = nn.Linear(config.width, EVIDENCE_WEIGHTS)
        self.factor = nn.Linear(config.width, EVIDENCE_WEIGHTS**2)
        self.log_odds = nn.Linear(config.width, len(UNUSUAL))
        self.register_buffer("units", torch.tensor(WEIGHT_UNITS))
        self.register_buffer("below", torch.tril(torch.ones(EVIDENCE_WEIGHTS, EVIDENCE_WEIGHTS), -1))
        self.register_buffer("diagonal", torch.eye(EVIDENCE_WEIGHTS))

    def forward(self, vectors: Tensor) -> EvidenceTensors:
        """Return locations (N, 5), factors (N, 5, 5) and log-odds (N, 3) of vectors (N, inputs)."""
        hidden = self.trunk(vectors)
        raw = self.factor(hidden).unflatten(1, (EVIDENCE_WEIGHTS, EVIDENCE_WEIGHTS)).clamp(-LARGEST_RAW, LARGEST_RAW)
        factors = raw * self.below + raw.exp() * self.diagonal
        return self.location(hidden) * self.units, factors / self.units[:, None], self.log_odds(hidden)


class PhotographNet(nn.Module):
    """Windows of photographs to evidence: of each window and of each photograph.

    The pooling is learned (docs/METHOD.md, Eq. 17). The vector of a photograph has two parts: the mean of its windows'
    vectors, weighted by a score that each window earns, and the vector of the sum of its windows' statistics.
    """

    def __init__(self, config: NetworkConfig) -> None:
        super().__init__()
        self.embedding = Embedding(config)
        self.score = nn.Linear(config.width, 1)
        self.window = Head(config.width, config)
        self.photograph = Head(2 * config.width, config)

    def forward(self, statistics: Tensor, present: Tensor) -> tuple[EvidenceTensors, EvidenceTensors]:
        """Return the evidence of windows, (B, K, ...), and of photographs, (B, ...).

        `statistics`, (B, K, LENGTH), are of K windows of each of B photographs; windows count where `present`, bool
        (B, K), is true, at least one in each photograph.
        """
        together = (statistics * present[..., None]).sum(1, keepdim=True)
        rows = torch.cat([statistics, together], dim=1)  # (B, K + 1, LENGTH)
        vectors = self.embedding(rows.flatten(0, 1)).unflatten(0, rows.shape[:2])
        windows, whole = vectors[:, :-1], vectors[:, -1]
        scores = self.score(windows).squeeze(-1).masked_fill(~present, -torch.inf)
        pooled = (scores.softmax(1)[..., None] * windows).sum(1)
        location, factor, log_odds = (part.unflatten(0, present.shape) for part in self.window(windows.flatten(0, 1)))
        return (location, factor, log_odds), self.photograph(torch.cat([pooled, whole], dim=1))


class ShippedNetwork(nn.Module):
    """The network as it ships: the windows of one photograph, as one set."""

    def __init__(self, net: PhotographNet) -> None:
        super().__init__()
        self.net = net

    def forward(self, statistics: Tensor) -> tuple[Tensor, ...]:
        """Return the evidence of each window, (N, ...), and of all of them, (1, ...), of statistics (N, LENGTH)."""
        present = torch.ones(1, statistics.shape[0], dtype=torch.bool)
        windows, photograph = self.net(statistics[None], present)
        return (*(part[0] for part in windows), *photograph)


def _dense(inputs: int, config: NetworkConfig) -> nn.Sequential:
    """Return a layer from `inputs` values to the network's width."""
    return nn.Sequential(nn.Linear(inputs, config.width), nn.GELU(), nn.Dropout(config.dropout))
