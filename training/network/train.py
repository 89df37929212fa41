"""Train the photograph network on shards of statistics: ``python -m training.network.train --shards DIR --run DIR``."""

from __future__ import annotations

import argparse
import csv
import json
from dataclasses import asdict, dataclass
from pathlib import Path

import torch
from torch import Tensor
from tqdm import tqdm

from crfnet_core.emor import EmorBasis
from crfnet_core.files import atomic_write
from training.network.model import NetworkConfig, PhotographNet
from training.network.shards import HELD_OUT, TARGET_STRIDE, Shards, read_shards
from training.synthesis.photographs import FOLDS

#: Weights, beside the loss of the photographs' responses, of that of single windows and of the expected errors.
WINDOW_WEIGHT, EXPECTED_ERROR_WEIGHT = 0.3, 0.1


@dataclass(frozen=True)
class TrainingConfig:
    """The recipe: AdamW under one cycle of the learning rate.

    Parameters
    ----------
    all_windows : float
        Share of training photographs seen with all their windows; of the others, some are left out at random.
    without_held_out : bool
        Whether to leave out the photographs whose response is near a curve held out of P2.
    without_fold : int, optional
        The fold of training scenes to leave out and to validate on, instead of on the validation scenes.
    """

    epochs: int = 12
    batch: int = 256
    learning_rate: float = 1e-3
    weight_decay: float = 0.05
    all_windows: float = 0.6
    without_held_out: bool = False
    without_fold: int | None = None
    seed: int = 1


@dataclass
class Progress:
    """Everything that a run needs to go on from where it stopped."""

    net: PhotographNet
    optimizer: torch.optim.Optimizer
    schedule: torch.optim.lr_scheduler.OneCycleLR
    epoch: int = 0

    def save(self, path: Path) -> None:
        """Write the checkpoint, whole or not at all."""
        parts = {"net": self.net, "optimizer": self.optimizer, "schedule": self.schedule}
        state = {name: part.state_dict() for name, part in parts.items()}
        with atomic_write(path, overwrite=True) as temporary:
            torch.save(state | {"epoch": self.epoch}, temporary)

    def resume(self, path: Path) -> None:
        """Go on from a checkpoint."""
        state = torch.load(path, weights_only=True)
        self.net.load_state_dict(state["net"])
        self.optimizer.load_state_dict(state["optimizer"])
        self.schedule.load_state_dict(state["schedule"])
        self.epoch = state["epoch"]


class CurveLoss:
    """The estimation error itself, and the likelihood of the error that the network expects."""

    def __init__(self) -> None:
        basis = EmorBasis.load()
        self.mean = torch.from_numpy(basis.mean[::TARGET_STRIDE]).float()
        self.components = torch.from_numpy(basis.components[:, ::TARGET_STRIDE]).float()

    def errors(self, weights: Tensor, curves: Tensor) -> Tensor:
        """Return E_est, shape (...), of weights (..., 11) against responses (..., 128)."""
        squares = (self.mean + weights.float() @ self.components - curves) ** 2
        return (squares.sum(dim=-1) * TARGET_STRIDE + 1e-6).sqrt()

    def __call__(self, predictions: tuple[Tensor, Tensor, Tensor, Tensor], present: Tensor, curves: Tensor) -> Tensor:
        """Return the loss; an exponential distribution of mean exp(log_error) models every error."""
        window_weights, window_log_errors, weights, log_errors = predictions
        windows = self._with_likelihood(window_weights, window_log_errors.float(), curves[:, None])
        photographs = self._with_likelihood(weights, log_errors.float(), curves)
        return photographs.mean() + WINDOW_WEIGHT * windows[present].mean()

    def _with_likelihood(self, weights: Tensor, log_errors: Tensor, curves: Tensor) -> Tensor:
        """Return errors plus the weighted negative log likelihood of the expected ones."""
        errors = self.errors(weights, curves)
        return errors + EXPECTED_ERROR_WEIGHT * (errors.detach() * (-log_errors).exp() + log_errors)


def train(shards: Path, run: Path, config: TrainingConfig, network: NetworkConfig) -> Path:
    """Train until the last epoch, resuming what `run` holds, and return the path of the last checkpoint."""
    photographs, held_out = read_shards(shards, "train"), read_shards(shards, "validation")
    if config.without_held_out:
        photographs, held_out = (part.only(part.curve_sets != HELD_OUT) for part in (photographs, held_out))
    if config.without_fold is not None:
        left_out = photographs.folds == config.without_fold
        photographs, held_out = photographs.only(~left_out), photographs.only(left_out)
    progress = _start(network, config, len(photographs.curves))
    run.mkdir(parents=True, exist_ok=True)
    settings = {"training": asdict(config), "network": asdict(network), "photographs": len(photographs.curves)}
    (run / "config.json").write_text(json.dumps(settings, indent=2) + "\n")
    if (run / "last.pt").exists():
        progress.resume(run / "last.pt")
    loss = CurveLoss()
    while progress.epoch < config.epochs:
        train_loss = _train_epoch(progress, loss, photographs, config)
        window_error, error = validation_errors(progress.net, loss, held_out)
        with (run / "log.csv").open("a", newline="") as file:
            csv.writer(file).writerow([progress.epoch, f"{train_loss:.4f}", f"{window_error:.4f}", f"{error:.4f}"])
        progress.save(run / "last.pt")
    return run / "last.pt"


def validation_errors(net: PhotographNet, loss: CurveLoss, shards: Shards) -> tuple[float, float]:
    """Return the mean E_est of single windows and of whole photographs."""
    net.eval()
    windows, photographs = [], []
    with torch.inference_mode():
        for rows in torch.arange(len(shards.curves)).split(250):
            statistics, curves = shards.batch(rows)
            window_weights, _, weights, _ = net(statistics, torch.ones(statistics.shape[:2], dtype=torch.bool))
            windows.append(loss.errors(window_weights, curves[:, None]).flatten())
            photographs.append(loss.errors(weights, curves))
    return float(torch.cat(windows).mean()), float(torch.cat(photographs).mean())


def _start(network: NetworkConfig, config: TrainingConfig, photographs: int) -> Progress:
    """Return an untrained network with its optimizer and schedule."""
    torch.manual_seed(config.seed)
    net = PhotographNet(network)
    optimizer = torch.optim.AdamW(net.parameters(), lr=config.learning_rate, weight_decay=config.weight_decay)
    steps = config.epochs * (photographs // config.batch)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimizer, config.learning_rate, total_steps=steps, pct_start=0.15)
    return Progress(net, optimizer, schedule)


def _train_epoch(progress: Progress, loss: CurveLoss, shards: Shards, config: TrainingConfig) -> float:
    """Run one epoch, in an order that depends on the seed and the epoch only, and return the mean loss."""
    torch.manual_seed(config.seed * 1000 + progress.epoch)
    order = torch.randperm(len(shards.curves))
    batches = order[: len(order) // config.batch * config.batch].split(config.batch)
    total = 0.0
    progress.net.train()
    for rows in tqdm(batches, desc=f"epoch {progress.epoch + 1}/{config.epochs}", leave=False, disable=None):
        statistics, curves = shards.batch(rows)
        present = _some_windows(statistics.shape[:2], config.all_windows)
        with torch.autocast("cpu", torch.bfloat16):
            predictions = progress.net(statistics, present)
        value = loss(predictions, present, curves)
        progress.optimizer.zero_grad()
        value.backward()
        torch.nn.utils.clip_grad_norm_(progress.net.parameters(), 1.0)
        progress.optimizer.step()
        progress.schedule.step()
        total += float(value.detach())
    progress.epoch += 1
    return total / len(batches)


def _some_windows(shape: torch.Size, all_windows: float) -> Tensor:
    """Return which windows of each photograph are present, bool (B, K): all of them, or 1 to K at random."""
    count = torch.where(torch.rand(shape[0]) < all_windows, shape[1], torch.randint(1, shape[1] + 1, (shape[0],)))
    return torch.rand(*shape).argsort(dim=1) < count[:, None]


def main() -> None:
    """Train as the options say."""
    defaults, sizes = TrainingConfig(), NetworkConfig()
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--shards", type=Path, required=True, help="folder written by training.network.shards")
    parser.add_argument("--run", type=Path, required=True, help="folder of the checkpoints and the log")
    parser.add_argument("--epochs", type=int, default=defaults.epochs)
    parser.add_argument("--learning-rate", type=float, default=defaults.learning_rate)
    parser.add_argument("--weight-decay", type=float, default=defaults.weight_decay)
    parser.add_argument("--without-held-out", action="store_true", help="leave out the curves that P2 measures on")
    parser.add_argument("--without-fold", type=int, choices=range(FOLDS), help="leave out and validate on these scenes")
    parser.add_argument("--dropout", type=float, default=sizes.dropout)
    parser.add_argument("--width", type=int, default=sizes.width)
    parser.add_argument("--seed", type=int, default=defaults.seed)
    options = vars(parser.parse_args())
    network = NetworkConfig(dropout=options.pop("dropout"), width=options.pop("width"))
    last = train(options.pop("shards"), options.pop("run"), TrainingConfig(**options), network)
    print((last.parent / "log.csv").read_text(), end="")


if __name__ == "__main__":
    main()
