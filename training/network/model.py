"""The photograph network: statistics of windows in, one response for all of them out."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor, nn

from crfnet_core.emor import COMPONENTS
from crfnet_core.statistics import CANDIDATE_PARTS, COLOR_LEVELS, COLOR_STRIDES, GRID, LEVELS, PARTS, STRIDES

#: Features per channel: a histogram and, per stride, four means at every level.
LEVEL_FEATURES = LEVELS * (1 + 4 * len(STRIDES))

#: Features of edges: per stride and cell, how many there are and where their middles lie.
EDGE_FEATURES = 2 * len(STRIDES) * GRID**2

#: How much the bend may change from level to level, in units of the mean evidence per level: two readings of it.
SMOOTHNESS = (1e-2, 1e-1)

#: Features of the equations between channels: per stride, the bends read and the evidence, at every level.
COLOR_FEATURES = len(COLOR_STRIDES) * (len(SMOOTHNESS) + 1) * COLOR_LEVELS

#: Features of candidate responses: means at every candidate, and how many samples they are of.
CANDIDATE_FEATURES = sum(torch.Size(part).numel() for part in CANDIDATE_PARTS)

#: Mixtures that a mean at a candidate is given beforehand.
CANDIDATE_PRIOR = 50.0

#: Evidence, in squared codes, that a level's bend of 0 is given beforehand.
COLOR_PRIOR = 3.0

#: Share of its first squared residual at which a system counts as solved.
CONVERGED = 1e-10

#: Samples that a level or cell is given beforehand, so that one with few of them says little.
PRIOR = 4.0


@dataclass(frozen=True)
class NetworkConfig:
    """Sizes of the network, and shares of hidden values and of whole kinds of features that training leaves out."""

    width: int = 384
    dropout: float = 0.1
    kind_dropout: float = 0.15


class Features(nn.Module):
    """Statistics, shape (..., STATISTICS), as features that do not grow with the number of samples.

    Statistics of several windows may be summed before: see `crfnet_core.statistics.window_statistics`.
    """

    def forward(self, statistics: Tensor) -> tuple[Tensor, Tensor, Tensor, Tensor]:
        """Return features per channel, (..., 3, LEVEL_FEATURES), of edges, of equations, and of candidates."""
        sizes = [int(torch.Size(part).numel()) for part in PARTS]
        histogram, neighbours, edges, colors, *candidates = (
            part.unflatten(-1, shape) for part, shape in zip(statistics.split(sizes, dim=-1), PARTS, strict=True)
        )
        samples = histogram.sum(-1, keepdim=True)
        levels = [(histogram * LEVELS / samples + 1e-2).log()]
        for stride in neighbours.unbind(-4):
            size, log_size, flat, lean, count = stride.unbind(-2)
            count = count + PRIOR
            levels += [(size / count + 0.1).log(), log_size / count, flat / count, lean / (size + count / 2)]
        count, place = edges.unbind(-3)
        share = (count * 1e4 / samples.sum((-1, -2))[..., None, None, None] + 1).log()
        places = torch.stack([share, place / (count + PRIOR) * 4], dim=-3)
        bends, means = self._bends(colors).flatten(-3), self._means(candidates)
        return torch.cat(levels, dim=-1), places.flatten(-4), bends, means

    def _means(self, parts: list[Tensor]) -> Tensor:
        """Return `CANDIDATE_PARTS` as means and logarithms of the numbers of samples, (..., CANDIDATE_FEATURES)."""
        features = []
        for sums, numbers, shape in zip(parts[::2], parts[1::2], CANDIDATE_PARTS[::2], strict=True):
            features += [
                (sums / (numbers + CANDIDATE_PRIOR)).flatten(-len(shape)),
                (numbers + 10).log().flatten(-len(shape)),
            ]
        return torch.cat(features, dim=-1)

    def _bends(self, equations: Tensor) -> Tensor:
        """Return bends of the inverse response and the logarithm of their evidence, shape (..., S, 3, COLOR_LEVELS)."""
        matrix, right = equations[..., :-1, :], equations[..., -1, :]
        evidence = torch.diagonal(matrix, dim1=-2, dim2=-1)
        scale = evidence.mean(-1)[..., None, None]
        bends = []
        for smoothness in SMOOTHNESS:
            prior = COLOR_PRIOR * torch.eye(COLOR_LEVELS, device=matrix.device)
            smooth = smoothness * scale * _second_differences().to(matrix)
            bends.append((solved(matrix + prior + smooth, right) / 10).clamp(-3, 3))
        return torch.stack([*bends, (evidence + 1).log()], dim=-2)


def solved(matrix: Tensor, right: Tensor, steps: int = 2 * COLOR_LEVELS) -> Tensor:
    """Return x of A x = r for positive definite A (..., L, L) and r (..., L), by conjugate gradients.

    A fixed number of steps of products, which every runtime has, in place of a decomposition.
    """
    inverse_diagonal = 1 / torch.diagonal(matrix, dim1=-2, dim2=-1)
    x, residual = torch.zeros_like(right), right
    direction = inverse_diagonal * residual
    size = first = (residual * direction).sum(-1, keepdim=True)
    for _ in range(steps):
        going = size > CONVERGED * first
        turned = (matrix @ direction[..., None]).squeeze(-1)
        length = _share(going, size, (direction * turned).sum(-1, keepdim=True))
        x, residual = x + length * direction, residual - length * turned
        preconditioned = inverse_diagonal * residual
        before, size = size, (residual * preconditioned).sum(-1, keepdim=True)
        direction = preconditioned + _share(going, size, before) * direction
    return x


def _share(chosen: Tensor, part: Tensor, whole: Tensor) -> Tensor:
    """Return part / whole where chosen, else 0; no tiny number guards it, since graph optimisers drop these."""
    return torch.where(chosen, part, 0) / torch.where(chosen, whole, 1)


def _second_differences() -> Tensor:
    """Return D' D, shape (COLOR_LEVELS, COLOR_LEVELS), for the second differences D of neighbouring levels."""
    differences = torch.diff(torch.eye(COLOR_LEVELS), n=2, dim=0)
    return differences.T @ differences


def _dense(inputs: int, config: NetworkConfig) -> nn.Sequential:
    """Return a layer from `inputs` values to the network's width."""
    return nn.Sequential(nn.Linear(inputs, config.width), nn.GELU(), nn.Dropout(config.dropout))


class Embedding(nn.Module):
    """Statistics, of one window or summed over several, as a vector."""

    def __init__(self, config: NetworkConfig) -> None:
        super().__init__()
        width, self.kind_dropout = config.width, config.kind_dropout
        self.features = Features()
        self.level_normal = nn.BatchNorm1d(LEVEL_FEATURES, affine=False)
        self.edge_normal = nn.BatchNorm1d(EDGE_FEATURES, affine=False)
        self.channel = _dense(LEVEL_FEATURES, config)
        self.edges = _dense(EDGE_FEATURES, config)
        self.color_normal = nn.BatchNorm1d(COLOR_FEATURES, affine=False)
        self.colors = _dense(COLOR_FEATURES, config)
        self.candidate_normal = nn.BatchNorm1d(CANDIDATE_FEATURES, affine=False)
        self.candidates = _dense(CANDIDATE_FEATURES, config)
        self.trunk = _dense(5 * width, config)

    def forward(self, statistics: Tensor) -> Tensor:
        """Return vectors, shape (N, width), of statistics of shape (N, STATISTICS)."""
        with torch.no_grad(), torch.autocast("cpu", enabled=False):
            levels, edges, colors, candidates = self.features(statistics)
        levels = self.level_normal(levels.flatten(0, 1)).unflatten(0, (-1, 3))
        channels = self.channel(self._kept(levels))
        edges = self.edges(self._kept(self.edge_normal(edges)))
        colors = self.colors(self._kept(self.color_normal(colors)))
        candidates = self.candidates(self._kept(self.candidate_normal(candidates)))
        return self.trunk(torch.cat([channels.mean(1), channels.amax(1), edges, colors, candidates], dim=1))

    def _kept(self, features: Tensor) -> Tensor:
        """Return normalised features within 6 deviations; in training, those of some rows as 0."""
        features = features.clamp(-6, 6)
        if not self.training:
            return features
        row = (len(features), *[1] * (features.ndim - 1))
        return features * (torch.rand(row, device=features.device) >= self.kind_dropout)


class Head(nn.Module):
    """A vector as EMoR weights and the logarithm of the expected estimation error."""

    def __init__(self, inputs: int, config: NetworkConfig) -> None:
        super().__init__()
        width = config.width
        self.trunk = _dense(inputs, config)
        self.weights = nn.Linear(width, COMPONENTS)
        self.log_error = nn.Linear(width, 1)

    def forward(self, vectors: Tensor) -> tuple[Tensor, Tensor]:
        """Return weights (N, 11) and log errors (N,)."""
        hidden = self.trunk(vectors)
        return self.weights(hidden), self.log_error(hidden).squeeze(1)


class PhotographNet(nn.Module):
    """Windows of photographs -> EMoR weights and log expected errors, of each window and of each photograph.

    The pooling is learned: the vector of a photograph holds the mean of its windows' vectors, weighted by a score that
    each window earns, and the vector of all its windows' statistics taken together.
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
        statistics : Tensor, shape (B, K, STATISTICS)
            Of K windows of each of B photographs.
        present : Tensor, bool, shape (B, K)
            Which windows count; at least one of each photograph.
        """
        together = (statistics * present[..., None]).sum(1, keepdim=True)
        rows = torch.cat([statistics, together], dim=1)
        vectors = self.embedding(rows.flatten(0, 1)).unflatten(0, rows.shape[:2])
        windows, whole = vectors[:, :-1], vectors[:, -1]
        scores = self.score(windows).squeeze(-1).masked_fill(~present, -torch.inf)
        pooled = (scores.softmax(1)[..., None] * windows).sum(1)
        weights, log_errors = self.window(windows.flatten(0, 1))
        weights, log_errors = weights.unflatten(0, present.shape), log_errors.unflatten(0, present.shape)
        return weights, log_errors, *self.photograph(torch.cat([pooled, whole], dim=1))


class ShippedNetwork(nn.Module):
    """The network as it ships: the windows of one photograph, or of several of one camera, as one set."""

    def __init__(self, net: PhotographNet) -> None:
        super().__init__()
        self.net = net

    def forward(self, statistics: Tensor) -> tuple[Tensor, Tensor, Tensor, Tensor]:
        """Return weights (N, 11), log errors (N,), pooled ones (1, 11) and (1,), of statistics (N, STATISTICS)."""
        present = torch.ones(1, statistics.shape[0], dtype=torch.bool)
        weights, log_errors, pooled, pooled_log_error = self.net(statistics[None], present)
        return weights[0], log_errors[0], pooled, pooled_log_error
