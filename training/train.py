"""Train the window network on shards of statistics: ``python -m training.train --shards DIR --run DIR``."""

from __future__ import annotations

import argparse
import csv
import json
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import torch
from torch import Tensor
from tqdm import tqdm

from crfnet_core.emor import EmorBasis
from crfnet_core.files import written_whole
from training.dataset import TARGET_STRIDE, read_shards
from training.model import NetworkConfig, ResponseNet

#: Weight of the loss of the expected error beside that of the response.
EXPECTED_ERROR_WEIGHT = 0.1


@dataclass(frozen=True)
class TrainingConfig:
    """The recipe: AdamW under one cycle of the learning rate."""

    epochs: int = 10
    batch: int = 512
    learning_rate: float = 1e-3
    weight_decay: float = 0.05
    feature_noise: float = 0.2
    seed: int = 1


@dataclass
class Progress:
    """Everything that a run needs to go on from where it stopped."""

    net: ResponseNet
    optimizer: torch.optim.Optimizer
    schedule: torch.optim.lr_scheduler.OneCycleLR
    epoch: int = 0

    def save(self, path: Path) -> None:
        """Write the checkpoint, whole or not at all."""
        parts = {"net": self.net, "optimizer": self.optimizer, "schedule": self.schedule}
        state = {name: part.state_dict() for name, part in parts.items()}
        with written_whole(path, overwrite=True) as temporary:
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
        """Return E_est per window, shape (N,), of weights (N, 11) against responses (N, 128)."""
        squares = (self.mean + weights @ self.components - curves) ** 2
        return (squares.sum(dim=1) * TARGET_STRIDE + 1e-6).sqrt()

    def __call__(self, weights: Tensor, log_error: Tensor, curves: Tensor) -> Tensor:
        """Return the loss; an exponential distribution of mean exp(log_error) models the error."""
        errors = self.errors(weights, curves)
        likelihood = errors.detach() * (-log_error).exp() + log_error
        return (errors + EXPECTED_ERROR_WEIGHT * likelihood).mean()


def train(shards: Path, run: Path, config: TrainingConfig, network: NetworkConfig) -> Path:
    """Train until the last epoch, resuming what `run` holds, and return the path of the best checkpoint."""
    statistics, curves = read_shards(shards, "train")
    held_out = read_shards(shards, "validation")
    torch.manual_seed(config.seed)
    progress = _start(network, config, statistics)
    run.mkdir(parents=True, exist_ok=True)
    (run / "config.json").write_text(json.dumps({"training": asdict(config), "network": asdict(network)}, indent=2))
    if (run / "last.pt").exists():
        progress.resume(run / "last.pt")
    loss = CurveLoss()
    best = min((error for _, _, error in _read_log(run)), default=np.inf)
    while progress.epoch < config.epochs:
        train_error = _train_epoch(progress, loss, statistics, curves, config)
        error = validation_error(progress.net, loss, *held_out)
        if error < best:
            best = error
            progress.save(run / "best.pt")
        with (run / "log.csv").open("a", newline="") as file:
            csv.writer(file).writerow([progress.epoch, f"{train_error:.4f}", f"{error:.4f}"])
        progress.save(run / "last.pt")
    return run / "best.pt"


def validation_error(net: ResponseNet, loss: CurveLoss, statistics: Tensor, curves: Tensor) -> float:
    """Return the mean E_est of single windows."""
    net.eval()
    with torch.inference_mode():
        errors = [
            loss.errors(net(rows.float())[0], targets)
            for rows, targets in zip(statistics.split(1000), curves.split(1000), strict=True)
        ]
    return float(torch.cat(errors).mean())


def _start(network: NetworkConfig, config: TrainingConfig, statistics: Tensor) -> Progress:
    """Return an untrained network that standardises its input as the training windows are distributed."""
    net = ResponseNet(network)
    sample = statistics[:: max(1, len(statistics) // 8000)].float()
    net.offset.copy_(sample.mean(dim=0))
    net.scale.copy_(1 / (sample.std(dim=0) + 1e-2))
    optimizer = torch.optim.AdamW(net.parameters(), lr=config.learning_rate, weight_decay=config.weight_decay)
    steps = config.epochs * (len(statistics) // config.batch)
    schedule = torch.optim.lr_scheduler.OneCycleLR(optimizer, config.learning_rate, total_steps=steps, pct_start=0.2)
    return Progress(net, optimizer, schedule)


def _train_epoch(
    progress: Progress, loss: CurveLoss, statistics: Tensor, curves: Tensor, config: TrainingConfig
) -> float:
    """Run one epoch, in an order that depends on the seed and the epoch only, and return the mean loss."""
    torch.manual_seed(config.seed * 1000 + progress.epoch)
    order = torch.randperm(len(statistics))
    batches = order[: len(order) // config.batch * config.batch].split(config.batch)
    total = 0.0
    progress.net.train()
    for rows in tqdm(batches, desc=f"epoch {progress.epoch + 1}/{config.epochs}", leave=False, disable=None):
        spread = config.feature_noise / progress.net.scale
        noisy = statistics[rows].float() + spread * torch.randn(len(rows), len(spread))
        with torch.autocast("cpu", torch.bfloat16):
            weights, log_error = progress.net(noisy)
        value = loss(weights.float(), log_error.float(), curves[rows])
        progress.optimizer.zero_grad()
        value.backward()
        torch.nn.utils.clip_grad_norm_(progress.net.parameters(), 1.0)
        progress.optimizer.step()
        progress.schedule.step()
        total += float(value.detach())
    progress.epoch += 1
    return total / len(batches)


def _read_log(run: Path) -> list[tuple[int, float, float]]:
    """Return (epoch, training loss, validation E_est) of the epochs done."""
    if not (run / "log.csv").exists():
        return []
    with (run / "log.csv").open(newline="") as file:
        return [(int(epoch), float(loss), float(error)) for epoch, loss, error in csv.reader(file)]


def main() -> None:
    """Train as the options say."""
    defaults, sizes = TrainingConfig(), NetworkConfig()
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--shards", type=Path, required=True, help="folder written by training.dataset")
    parser.add_argument("--run", type=Path, required=True, help="folder of the checkpoints and the log")
    parser.add_argument("--epochs", type=int, default=defaults.epochs)
    parser.add_argument("--learning-rate", type=float, default=defaults.learning_rate)
    parser.add_argument("--weight-decay", type=float, default=defaults.weight_decay)
    parser.add_argument("--feature-noise", type=float, default=defaults.feature_noise)
    parser.add_argument("--dropout", type=float, default=sizes.dropout)
    parser.add_argument("--width", type=int, default=sizes.width)
    parser.add_argument("--seed", type=int, default=defaults.seed)
    options = vars(parser.parse_args())
    network = NetworkConfig(dropout=options.pop("dropout"), width=options.pop("width"))
    best = train(options.pop("shards"), options.pop("run"), TrainingConfig(**options), network)
    print((best.parent / "log.csv").read_text(), end="")


if __name__ == "__main__":
    main()
