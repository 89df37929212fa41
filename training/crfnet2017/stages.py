"""The two stages of the training: tell the known responses apart, then estimate EMoR weights."""

import math

import numpy as np
import torch
from torch import Tensor, nn

from crfnet_core.response.emor import COMPONENTS, EmorBasis

STAGES = ("classify", "regress")


class StageTask:
    """The loss and the validation figure of a stage, for windows under `responses`, shape (N, 1024), of DoRF (N = 201).

    "classify" has cross-entropy and top-1 accuracy, "regress" the distance of the EMoR weights and the mean E_est.
    `squared` is as in `training.crfnet2017.recipes.Recipe`.
    """

    def __init__(self, stage: str, responses: Tensor, *, squared: bool) -> None:
        basis, curves, device = EmorBasis.load(), responses.cpu().double().numpy(), responses.device
        weights = basis.project(curves)
        residuals = np.linalg.norm(basis.reconstruct(weights) - curves, axis=1)
        self.classifies, self.squared = stage == "classify", squared
        self.weights = torch.from_numpy(weights).float().to(device)
        self.residuals = torch.from_numpy(residuals).float().to(device)
        self.outputs = len(weights) if self.classifies else COMPONENTS

    def loss(self, outputs: Tensor, classes: Tensor) -> Tensor:
        """Return the loss, mean over the batch, of outputs (N, outputs) for the responses numbered `classes` (N,)."""
        if self.classifies:
            return nn.functional.cross_entropy(outputs, classes)
        squares = self._squares(outputs, classes)
        return squares.mean() / 2 if self.squared else (squares + 1e-8).sqrt().mean()

    def figures(self, outputs: Tensor, classes: Tensor) -> Tensor:
        """Return for every window, shape (N,), whether the right response scores highest (1 or 0), or E_est.

        The basis is orthonormal, so E_est squared is the squared distance of the weights plus the squared distance
        of the true response from the basis.
        """
        if self.classifies:
            return (outputs.argmax(dim=1) == classes).float()
        return (self._squares(outputs, classes) + self.residuals[classes].square()).sqrt()

    def is_better(self, figure: float, others: list[float]) -> bool:
        """Return whether a validation figure is better than all others."""
        return figure > max(others, default=-math.inf) if self.classifies else figure < min(others, default=math.inf)

    def _squares(self, outputs: Tensor, classes: Tensor) -> Tensor:
        """Return the squared distances of the weights."""
        return (outputs - self.weights[classes]).square().sum(dim=1)
