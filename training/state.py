"""The state of a training: a network, the moving average of its weights, which a run yields, and how far it is."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import torch
from torch import Tensor, nn
from torch.optim.swa_utils import AveragedModel, get_ema_multi_avg_fn

from crfnet_core.files import atomic_write


def moving_average(network: nn.Module, steps: float) -> AveragedModel:
    """Return the exponential average of a network's weights and of the statistics of its normalizations.

    `AveragedModel.update_parameters` takes the network after each step. The average reaches back over `steps`; with 1
    it is the network itself. Source: Polyak & Juditsky, 1992.
    """
    return AveragedModel(network, multi_avg_fn=get_ema_multi_avg_fn(1 - 1 / steps), use_buffers=True)


@dataclass
class TrainingState:
    """All that a run needs to go on from where it stopped."""

    network: nn.Module
    averaged: AveragedModel  # the moving average of the network's weights
    optimizer: torch.optim.Optimizer
    schedule: torch.optim.lr_scheduler.LRScheduler  # of the learning rate
    done: int = 0  # steps or epochs that are done
    rows: list[list[float]] = field(default_factory=list)  # the log

    def move(self, loss: Tensor, *, clip: float) -> None:
        """Move the weights once along the gradient of a loss, whose norm is cut to `clip`, or not at all by 0."""
        self.optimizer.zero_grad()
        loss.backward()
        if clip:
            nn.utils.clip_grad_norm_(self.network.parameters(), clip)
        self.optimizer.step()
        self.schedule.step()
        self.averaged.update_parameters(self.network)

    def save(self, path: Path) -> None:
        """Write the checkpoint, whole or not at all; its "network" is the average, "moving" the weights that go on."""
        states = {name: part.state_dict() for name, part in self._parts.items()}
        with atomic_write(path, overwrite=True) as temporary:
            torch.save(states | {"done": self.done, "rows": self.rows}, temporary)

    def resume(self, path: Path, device: torch.device | str = "cpu") -> None:
        """Go on from a checkpoint."""
        state = torch.load(path, map_location=device, weights_only=True)
        for name, part in self._parts.items():
            part.load_state_dict(state[name])
        self.averaged.n_averaged.fill_(1)  # the next step adds to the average, and does not replace it
        self.done, self.rows = state["done"], state["rows"]

    @property
    def _parts(self) -> dict[str, Any]:
        """The parts of a checkpoint that have states of their own."""
        weights = {"network": self.averaged.module, "moving": self.network}
        return weights | {"optimizer": self.optimizer, "schedule": self.schedule}
