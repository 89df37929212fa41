"""The loss (docs/METHOD.md, Eq. 18): E_est of the responses, and the likelihood of the errors that are expected."""

from __future__ import annotations

import torch
from torch import Tensor

from crfnet_core.emor import EmorBasis
from training.network.shards import TARGET_STRIDE

#: Weights of the loss of single windows, and of the likelihood of the errors, relative to the photographs' E_est.
WINDOW_WEIGHT, EXPECTED_ERROR_WEIGHT = 0.3, 0.1


class CurveLoss:
    """E_est of photographs and windows, and the negative log likelihood of it under the expected error."""

    def __init__(self) -> None:
        basis = EmorBasis.load()
        self.mean = torch.from_numpy(basis.mean[::TARGET_STRIDE]).float()
        self.components = torch.from_numpy(basis.components[:, ::TARGET_STRIDE]).float()

    def errors(self, weights: Tensor, curves: Tensor) -> Tensor:
        """Return E_est, shape (...), of weights (..., 11) against responses (..., 128), which keep every 8th sample."""
        squares = (self.mean + weights.float() @ self.components - curves) ** 2
        return (squares.sum(dim=-1) * TARGET_STRIDE + 1e-6).sqrt()

    def __call__(self, predictions: tuple[Tensor, Tensor, Tensor, Tensor], present: Tensor, curves: Tensor) -> Tensor:
        """Return the loss of the outputs of `training.network.model.PhotographNet`.

        Parameters
        ----------
        predictions : tuple of Tensor
            Window weights (B, K, 11), window log errors (B, K), weights (B, 11) and log errors (B,).
        present : Tensor, bool, shape (B, K)
            Which windows count.
        curves : Tensor, shape (B, 128)
            The true responses.
        """
        window_weights, window_log_errors, weights, log_errors = predictions
        windows = self._with_likelihood(window_weights, window_log_errors.float(), curves[:, None])
        photographs = self._with_likelihood(weights, log_errors.float(), curves)
        return photographs.mean() + WINDOW_WEIGHT * windows[present].mean()

    def _with_likelihood(self, weights: Tensor, log_errors: Tensor, curves: Tensor) -> Tensor:
        """Return the errors plus their negative log likelihood under exponentials of mean exp(log_errors)."""
        errors = self.errors(weights, curves)
        return errors + EXPECTED_ERROR_WEIGHT * (errors.detach() * (-log_errors).exp() + log_errors)
