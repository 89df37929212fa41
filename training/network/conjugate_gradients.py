"""Conjugate gradients: a linear solver made of products alone, which every ONNX runtime has."""

from __future__ import annotations

import torch
from torch import Tensor

#: A system counts as solved when the squared residual has fallen to this fraction of the first one.
CONVERGED = 1e-10


def conjugate_gradients(matrix: Tensor, right: Tensor, *, steps: int) -> Tensor:
    """Return x of A x = r, shape (..., L), for symmetric positive definite A (..., L, L) and r (..., L).

    The residuals are preconditioned with the diagonal. The number of steps is fixed, because a graph has no loop that
    ends by itself; a system that is solved before changes no more.
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
