"""The window network: statistics that carry the response, then a small network; one graph from pixels to weights."""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor, nn

from crfnet_core.emor import COMPONENTS

#: Code values of an 8-bit photograph.
CODES = 256

#: Levels on which edges are first counted.
EDGE_LEVELS = 64

#: Codes between the two sides of an edge, at least, for the place of its middle to mean anything.
LEAST_EDGE = 6


@dataclass(frozen=True)
class NetworkConfig:
    """Sizes of the statistics and of the network."""

    levels: int = 64
    grid: int = 16
    strides: tuple[int, ...] = (1, 2, 4, 8, 16)
    width: int = 384
    dropout: float = 0.2

    @property
    def level_features(self) -> int:
        """Statistics per channel: a histogram and, per stride, four means at every brightness level."""
        return self.levels * (1 + 4 * len(self.strides))

    @property
    def grid_features(self) -> int:
        """Statistics of edges: per stride, how many and where the middle sample lies, over (a, c)."""
        return 2 * len(self.strides) * self.grid**2

    @property
    def features(self) -> int:
        """Length of a window's statistics."""
        return 3 * self.level_features + self.grid_features


class WindowStatistics(nn.Module):
    """Statistics of windows that trace the bend of the response.

    Irradiance mixes linearly across an edge, and its relative gradients hardly depend on its level. So both the
    gradients at each brightness level, and the place of the middle one b of three samples a, b, c in a row between the
    outer two, follow the slope and the bend of the response. Per channel and level: the histogram and, per stride, the
    means over neighbours of |d|, log |d|, flatness and d. Over the grid (a, c): the number of edges and the mean place
    of b. The ideas are those of Lin, Gu, Yamazaki & Shum, "Radiometric calibration from a single image", CVPR 2004.

    Everything is counted on the 256 code values, then gathered into levels by linear interpolation.
    """

    def __init__(self, config: NetworkConfig) -> None:
        super().__init__()
        self.config = config
        code = torch.arange(CODES)
        distance = (code[:, None] - code[None, :]).float()
        tables = torch.stack([distance.abs(), (distance.abs() + 1).log(), (distance == 0).float(), -distance])
        self.register_buffer("tables", torch.cat([tables, torch.ones(1, CODES, CODES)]), persistent=False)
        self.register_buffer("levels", _triangles(CODES, config.levels), persistent=False)
        self.register_buffer("cells", _triangles(EDGE_LEVELS, config.grid), persistent=False)

    def forward(self, windows: Tensor) -> Tensor:
        """Return statistics, shape (N, features), of windows of shape (N, 3, 227, 227) in [0, 1]."""
        codes = (windows * (CODES - 1)).round().int()
        levels = [self._histogram(codes)]
        grids = []
        for stride in self.config.strides:
            a, b, c = _triples(codes, stride)
            levels.append(self._level_means(a, b, c))
            grids.append(self._edge_grid(a, b, c))
        return torch.cat([torch.cat(levels, dim=2).flatten(1), torch.cat(grids, dim=1)], dim=1)

    def _histogram(self, codes: Tensor) -> Tensor:
        """Return the logarithm of the share of samples at each level, shape (N, 3, levels)."""
        counts = _counted(codes.flatten(2), CODES)
        return ((counts @ self.levels) * self.config.levels / counts.sum(2, keepdim=True) + 1e-2).log()

    def _level_means(self, a: Tensor, b: Tensor, c: Tensor) -> Tensor:
        """Return four means over the neighbours of samples at each level, shape (N, 3, 4 * levels)."""
        pairs = _counted(torch.cat([b * CODES + a, b * CODES + c], dim=2), CODES * CODES)
        sums = (pairs.unflatten(2, (1, CODES, CODES)) * self.tables).sum(4) @ self.levels
        means = sums[:, :, :4] / (sums[:, :, 4:] + 4)
        size = (means[:, :, :1] + 0.1).log()
        lean = means[:, :, 3:] / (means[:, :, :1] + 0.5)
        return torch.cat([size, means[:, :, 1:3], lean], dim=2).flatten(2)

    def _edge_grid(self, a: Tensor, b: Tensor, c: Tensor) -> Tensor:
        """Return how many edges run from level a to level c and where b lies on them, shape (N, 2 * grid * grid)."""
        low, high = torch.minimum(a, c), torch.maximum(a, c)
        height = high - low
        between = ((height > LEAST_EDGE) & (b >= low) & (b <= high)).float()
        place = between * ((b - low).float() / (height + 1).float() - 0.5)
        per_level = EDGE_LEVELS / CODES
        cell = (low * per_level).int() * EDGE_LEVELS + (high * per_level).int()
        counts = self._gathered(_counted(cell, EDGE_LEVELS**2, between))
        moments = self._gathered(_counted(cell, EDGE_LEVELS**2, place))
        return torch.stack([(counts + 1).log(), moments / (counts + 4) * 4], dim=1).flatten(1)

    def _gathered(self, fine: Tensor) -> Tensor:
        """Return the fine grids of (N, 3, EDGE_LEVELS ** 2), summed over channels, as (N, grid, grid)."""
        square = fine.sum(1).unflatten(1, (EDGE_LEVELS, EDGE_LEVELS))
        return self.cells.T @ square @ self.cells


class ResponseNet(nn.Module):
    """Statistics -> EMoR weights and the logarithm of the expected estimation error."""

    def __init__(self, config: NetworkConfig) -> None:
        super().__init__()
        self.config = config
        width = config.width
        self.register_buffer("offset", torch.zeros(config.features))
        self.register_buffer("scale", torch.ones(config.features))
        self.channel = nn.Sequential(nn.Linear(config.level_features, width), nn.GELU(), nn.Dropout(config.dropout))
        self.edges = nn.Sequential(nn.Linear(config.grid_features, width), nn.GELU(), nn.Dropout(config.dropout))
        self.trunk = nn.Sequential(
            nn.Linear(3 * width, width),
            nn.GELU(),
            nn.Dropout(config.dropout),
            nn.Linear(width, width),
            nn.GELU(),
            nn.Dropout(config.dropout),
        )
        self.weights = nn.Linear(width, COMPONENTS)
        self.log_error = nn.Linear(width, 1)

    def forward(self, statistics: Tensor) -> tuple[Tensor, Tensor]:
        """Return weights (N, 11) and log expected error (N,) from statistics of shape (N, features)."""
        normal = ((statistics - self.offset) * self.scale).clamp(-6, 6)
        per_channel, edges = normal.split([3 * self.config.level_features, self.config.grid_features], dim=1)
        channels = self.channel(per_channel.unflatten(1, (3, self.config.level_features)))
        hidden = self.trunk(torch.cat([channels.mean(1), channels.amax(1), self.edges(edges)], dim=1))
        return self.weights(hidden), self.log_error(hidden).squeeze(1)


class WindowNetwork(nn.Module):
    """The network that ships: windows in, weights and log expected error out."""

    def __init__(self, statistics: WindowStatistics, net: ResponseNet) -> None:
        super().__init__()
        self.statistics = statistics
        self.net = net

    def forward(self, windows: Tensor) -> tuple[Tensor, Tensor]:
        """Return weights (N, 11) and log error (N,) of windows of shape (N, 227, 227, 3) in [0, 1]."""
        return self.net(self.statistics(windows.permute(0, 3, 1, 2)))


def _triples(codes: Tensor, stride: int) -> tuple[Tensor, Tensor, Tensor]:
    """Return the codes a, b, c, each (N, 3, P), of samples in a row, `stride` apart, along rows and columns."""
    size = codes.shape[3] - 2 * stride
    starts = (0, stride, 2 * stride)
    rows = [codes[:, :, :, start : start + size].flatten(2) for start in starts]
    columns = [codes[:, :, start : start + size, :].flatten(2) for start in starts]
    a, b, c = (torch.cat(pair, dim=2) for pair in zip(rows, columns, strict=True))
    return a, b, c


def _counted(places: Tensor, size: int, amounts: Tensor | None = None) -> Tensor:
    """Return how much falls on each of `size` places, shape (N, 3, size), from places of shape (N, 3, P)."""
    amounts = torch.ones_like(places, dtype=torch.float32) if amounts is None else amounts
    empty = torch.zeros((places.shape[0], places.shape[1], size), dtype=torch.float32, device=places.device)
    return empty.scatter_add(2, places.long(), amounts)


def _triangles(codes: int, levels: int) -> Tensor:
    """Return the linear-interpolation memberships of `codes` values in `levels` centres, shape (codes, levels)."""
    place = torch.linspace(0, levels - 1, codes)[:, None]
    return (1 - (place - torch.arange(levels)).abs()).clamp(min=0)
