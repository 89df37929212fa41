"""The statistics of windows as the network's input: means and logarithms in place of sums.

Sums grow with the number of samples, means do not: the network reads one window and several together alike.
"""

import math

import torch
from torch import Tensor

from crfnet_core.statistics import COUNTS_OF, SHAPES, unpack
from crfnet_core.statistics.channel_equations import EQUATION_LEVELS, EQUATION_STRIDES
from crfnet_core.statistics.edges import GRID
from crfnet_core.statistics.gradients import LEVELS, STRIDES

#: Weights of the smoothness penalty (squared second differences of the curvature), relative to the mean diagonal of
#: the normal equations. The system is solved once with each; both solutions are features.
SMOOTHNESS = (1e-2, 1e-1)

#: Numbers of features: of each channel (a histogram, and four means per stride, at every level); of edges (how many,
#: and their mean encoded ratio, per stride and cell); of the channel equations (solutions and evidence per stride and
#: level); and of the candidate responses (means, and how many samples they are of).
LEVEL_FEATURES = LEVELS * (1 + 4 * len(STRIDES))
EDGE_FEATURES = 2 * len(STRIDES) * GRID**2
EQUATION_FEATURES = len(EQUATION_STRIDES) * (len(SMOOTHNESS) + 1) * EQUATION_LEVELS
CANDIDATE_FEATURES = sum(math.prod(SHAPES[name]) for pair in COUNTS_OF.items() for name in pair)

#: Pseudo-counts (docs/METHOD.md, Eq. 15): a mean is taken as if this number of samples of value 0 had been seen too,
#: so that few samples say little. The first is for samples at a level and edges in a cell, the second for mixtures and
#: shaded pairs under a candidate response.
SAMPLE_PSEUDO_COUNT, CANDIDATE_PSEUDO_COUNT = 4.0, 50.0

#: The same for the curvature: evidence, in squared codes, that it is 0 at a level.
CURVATURE_PSEUDO_EVIDENCE = 3.0

#: A system of equations counts as solved when the squared residual has fallen to this fraction of the first one.
CONVERGED = 1e-10

#: Unit of the curvature k = g'' / g' as a feature, and the largest absolute value of it in this unit.
CURVATURE_UNIT, CURVATURE_LIMIT = 10, 3


def features_of(statistics: Tensor) -> tuple[Tensor, Tensor, Tensor, Tensor]:
    """Return four kinds of features of statistics, shape (..., LENGTH): of one window, or summed over several.

    They are of the levels of each channel, (..., 3, LEVEL_FEATURES); of edges, (..., EDGE_FEATURES); of the channel
    equations, (..., EQUATION_FEATURES); and of the candidate responses, (..., CANDIDATE_FEATURES).
    """
    parts = unpack(statistics)
    return (
        level_features(parts["histogram"], parts["gradients"]),
        edge_features(parts["edges"], parts["histogram"].sum(-1).sum(-1)),
        curvature_features(parts["channel_equations"]),
        candidate_features(parts),
    )


def level_features(histogram: Tensor, gradients: Tensor) -> Tensor:
    """Return features of every channel, (..., 3, LEVEL_FEATURES): log densities, and mean gradients at every level."""
    features = [(histogram * LEVELS / histogram.sum(-1, keepdim=True) + 1e-2).log()]
    for sums in gradients.unbind(-4):  # (..., 3, GRADIENT_SUMS, LEVELS) of one stride
        absolute_difference, log_difference, equal, signed_difference, count = sums.unbind(-2)
        count = count + SAMPLE_PSEUDO_COUNT
        features += [
            (absolute_difference / count + 0.1).log(),
            log_difference / count,
            equal / count,
            signed_difference / (absolute_difference + count / 2),
        ]
    return torch.cat(features, dim=-1)


def edge_features(edges: Tensor, samples: Tensor) -> Tensor:
    """Return how many edges each cell holds and their mean encoded ratio less a half, (..., EDGE_FEATURES)."""
    count, ratio = edges.unbind(-3)  # (..., 5, GRID, GRID)
    log_fraction = (count * 1e4 / samples[..., None, None, None] + 1).log()
    mean_ratio = ratio / (count + SAMPLE_PSEUDO_COUNT) * 4
    return torch.stack([log_fraction, mean_ratio], dim=-3).flatten(-4)


def curvature_features(equations: Tensor) -> Tensor:
    """Return the curvature of the inverse response at every level, and log evidence, (..., EQUATION_FEATURES).

    The curvature k of docs/METHOD.md, Eq. 3, is the solution of the normal equations that `crfnet_core.statistics` adds
    up, with a smoothness penalty (Eq. 16): once with each weight of `SMOOTHNESS`.
    """
    matrix, right = equations[..., :-1, :], equations[..., -1, :]  # (..., 4, 20, 20) and (..., 4, 20)
    evidence = torch.diagonal(matrix, dim1=-2, dim2=-1)
    scale = evidence.mean(-1)[..., None, None]
    curvatures = []
    for smoothness in SMOOTHNESS:
        prior = CURVATURE_PSEUDO_EVIDENCE * torch.eye(EQUATION_LEVELS, device=matrix.device)
        penalty = smoothness * scale * _second_differences().to(matrix)
        curvature = conjugate_gradients(matrix + prior + penalty, right, steps=2 * EQUATION_LEVELS)
        curvatures.append((curvature / CURVATURE_UNIT).clamp(-CURVATURE_LIMIT, CURVATURE_LIMIT))
    return torch.stack([*curvatures, (evidence + 1).log()], dim=-2).flatten(-3)


def candidate_features(parts: dict[str, Tensor]) -> Tensor:
    """Return means under every candidate response and the logarithms of their counts, (..., CANDIDATE_FEATURES)."""
    features = []
    for name, counts_name in COUNTS_OF.items():
        sums, counts, axes = parts[name], parts[counts_name], len(SHAPES[name])
        features += [(sums / (counts + CANDIDATE_PSEUDO_COUNT)).flatten(-axes), (counts + 10).log().flatten(-axes)]
    return torch.cat(features, dim=-1)


def _second_differences() -> Tensor:
    """Return D' D, shape (EQUATION_LEVELS, EQUATION_LEVELS), for the second differences D of neighboring levels."""
    differences = torch.diff(torch.eye(EQUATION_LEVELS), n=2, dim=0)
    return differences.T @ differences


def conjugate_gradients(matrix: Tensor, right: Tensor, *, steps: int) -> Tensor:
    """Return x of A x = r, shape (..., L), for symmetric positive definite A (..., L, L) and r (..., L).

    Conjugate gradients, preconditioned with the diagonal, are made of products alone, which every ONNX runtime has. The
    steps are fixed, because a graph has no loop that ends by itself; a system that is solved before changes no more.
    """
    inverse_diagonal = 1 / torch.diagonal(matrix, dim1=-2, dim2=-1)
    x, residual = torch.zeros_like(right), right
    direction = inverse_diagonal * residual
    size = first = (residual * direction).sum(-1, keepdim=True)
    for _ in range(steps):
        is_unsolved = size > CONVERGED * first
        product = (matrix @ direction[..., None]).squeeze(-1)
        length = _safe_ratio(size, (direction * product).sum(-1, keepdim=True), is_unsolved)
        x, residual = x + length * direction, residual - length * product
        preconditioned = inverse_diagonal * residual
        before, size = size, (residual * preconditioned).sum(-1, keepdim=True)
        direction = preconditioned + _safe_ratio(size, before, is_unsolved) * direction
    return x


def _safe_ratio(part: Tensor, whole: Tensor, chosen: Tensor) -> Tensor:
    """Return part / whole where chosen, else 0; adding a tiny number would not do: graph optimizers drop these."""
    return torch.where(chosen, part, 0) / torch.where(chosen, whole, 1)
