"""Train the photograph network on shards of statistics: ``python -m training.network.train --shards DIR --run DIR``."""

import argparse
import csv
from dataclasses import asdict, dataclass
from pathlib import Path

import torch
from torch import Tensor
from tqdm import tqdm

from training.network.loss import ORDINARY, EvidenceLoss
from training.network.model import NetworkConfig, PhotographNet
from training.network.shards import CurveSet, Shards, read_shards, shard_files
from training.network.start import start_from, start_record
from training.provenance import data_record, record_run
from training.state import TrainingState, moving_average

CHECKPOINT = "last.pt"  # the file of the last checkpoint in the folder of a run
CLIP = 1.0  # largest norm of the gradient of a step
FIRST_DIVISOR = 25.0  # the learning rate begins at the highest one divided by this
COMPETITORS = 2048  # responses of training photographs that the truth competes with in the loss


@dataclass(frozen=True)
class TrainingConfig:
    """The recipe: AdamW under one cycle of the learning rate, and a moving average of the weights.

    A run yields the average, which takes the place of most of the decrease of the learning rate: the weights go on
    moving, and their mean does better on new scenes (training/EXPERIMENTS.md).
    """

    epochs: int = 12
    batch: int = 256
    learning_rate: float = 1e-3
    weight_decay: float = 0.05
    last_rate: float = 0.2  # the learning rate at the end of the cycle, as a part of the highest; above 0
    averaged_steps: float = 500.0  # steps that the average reaches back, exponentially; 1 for no average
    #: Fraction of the photographs seen with all their windows; of the others, some are left out at random.
    all_windows: float = 0.6
    #: Whether to leave out photographs whose response is, or is mixed from, a curve that P2 holds out.
    without_held_out: bool = False
    mixed: bool = True  # whether to compute in bfloat16 where that is safe; slow on processors that emulate it
    seed: int = 1  # of the initial weights and of the order of the photographs


def train(shards: Path, run: Path, config: TrainingConfig, network: NetworkConfig, *, init: Path | None = None) -> Path:
    """Train until the last epoch, resuming what `run` holds, and return the path of the last checkpoint.

    The folder `run` gets run.json, last.pt, and log.csv: epoch, training loss, and `validation_errors`. The run starts
    from the weights of `init`, a checkpoint or a model folder, as far as it has them. Raise SystemExit if `run` holds a
    run of another recipe or on other shards.
    """
    photographs, held_out = read_shards(shards, "train"), read_shards(shards, "validation")
    if config.without_held_out:
        photographs, held_out = (part.only(part.curve_sets != CurveSet.HELD_OUT) for part in (photographs, held_out))
    files = [path for split in ("train", "validation") for path in shard_files(shards, split)]
    recipe = {"training": asdict(config), "network": asdict(network), "photographs": len(photographs.weights)}
    record_run(run, recipe=recipe, seed=config.seed, data=data_record(shards, files), start=start_record(init))
    state = _start(network, config, len(photographs.weights))
    if (run / CHECKPOINT).exists():
        state.resume(run / CHECKPOINT)
    elif init is not None:
        start_from(state.network, init)
    # The truth competes with responses of training photographs, drawn by the seed.
    chosen = torch.randperm(len(photographs.weights), generator=torch.Generator().manual_seed(config.seed))
    competitors = photographs.only(chosen[:COMPETITORS])
    loss = EvidenceLoss(competitors.weights, competitors.families)
    while state.done < config.epochs:
        train_loss = _train_epoch(state, loss, photographs, config)
        window_error, error = validation_errors(state.averaged.module, loss, held_out)
        with (run / "log.csv").open("a", newline="") as file:
            csv.writer(file).writerow([state.done, f"{train_loss:.4f}", f"{window_error:.4f}", f"{error:.4f}"])
        state.save(run / CHECKPOINT)
    return run / CHECKPOINT


def validation_errors(net: PhotographNet, loss: EvidenceLoss, shards: Shards) -> tuple[float, float]:
    """Return the mean loss of photographs, and the mean distance of the posterior's mean from explained responses."""
    net.eval()
    losses, errors = [], []
    with torch.inference_mode():
        for rows in torch.arange(len(shards.weights)).split(250):
            statistics, weights = shards.batch(rows)
            families = shards.families[rows]
            _, evidence = net(statistics, torch.ones(statistics.shape[:2], dtype=torch.bool))
            losses.append(loss.of_each(evidence, weights, families))
            errors.append(loss.errors(loss.scores(evidence), weights)[families == ORDINARY])
    return float(torch.cat(losses).mean()), float(torch.cat(errors).mean())


def _start(network: NetworkConfig, config: TrainingConfig, photographs: int) -> TrainingState:
    """Return an untrained network with its optimizer and schedule."""
    torch.manual_seed(config.seed)
    net = PhotographNet(network)
    optimizer = torch.optim.AdamW(net.parameters(), lr=config.learning_rate, weight_decay=config.weight_decay)
    steps = config.epochs * (photographs // config.batch)
    schedule = torch.optim.lr_scheduler.OneCycleLR(
        optimizer,
        config.learning_rate,
        total_steps=steps,
        pct_start=0.15,
        div_factor=FIRST_DIVISOR,
        final_div_factor=1 / (FIRST_DIVISOR * config.last_rate),
    )
    return TrainingState(net, moving_average(net, config.averaged_steps), optimizer, schedule)


def _train_epoch(state: TrainingState, loss: EvidenceLoss, shards: Shards, config: TrainingConfig) -> float:
    """Run one epoch, in an order that depends on the seed and the epoch only, and return the mean loss."""
    torch.manual_seed(config.seed * 1000 + state.done)
    order = torch.randperm(len(shards.weights))
    batches = order[: len(order) // config.batch * config.batch].split(config.batch)
    total, families = 0.0, shards.families
    state.network.train()
    for rows in tqdm(batches, desc=f"epoch {state.done + 1}/{config.epochs}", leave=False, disable=None):
        statistics, weights = shards.batch(rows)
        present = _random_windows(statistics.shape[:2], config.all_windows)
        with torch.autocast("cpu", torch.bfloat16, enabled=config.mixed):
            windows, photographs = state.network(statistics, present)
        evidence = tuple(part.float() for part in windows), tuple(part.float() for part in photographs)
        value = loss(evidence, present, weights, families[rows])
        state.move(value, clip=CLIP)
        total += float(value.detach())
    state.done += 1
    return total / len(batches)


def _random_windows(shape: torch.Size, all_windows: float) -> Tensor:
    """Return which windows of each photograph are present, bool (B, K): all of them, or 1 to K at random."""
    count = torch.where(torch.rand(shape[0]) < all_windows, shape[1], torch.randint(1, shape[1] + 1, (shape[0],)))
    return torch.rand(*shape).argsort(dim=1) < count[:, None]


def main() -> None:
    """Train as the options say."""
    defaults = TrainingConfig()
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--shards", type=Path, required=True, help="folder written by training.network.shards")
    parser.add_argument("--run", type=Path, required=True, help="folder of the checkpoints and the log")
    parser.add_argument("--epochs", type=int, default=defaults.epochs)
    parser.add_argument("--learning-rate", type=float, default=defaults.learning_rate)
    parser.add_argument("--without-held-out", action="store_true", help="leave out the curves that P2 measures on")
    parser.add_argument(
        "--float32", dest="mixed", action="store_false", help="no bfloat16: faster on processors without AVX-512"
    )
    parser.add_argument("--init", type=Path, help="a checkpoint or a model folder to start from")
    parser.add_argument("--seed", type=int, default=defaults.seed)
    options = vars(parser.parse_args())
    shards, run, init = (options.pop(name) for name in ("shards", "run", "init"))
    last = train(shards, run, TrainingConfig(**options), NetworkConfig(), init=init)
    print((last.parent / "log.csv").read_text(), end="")


if __name__ == "__main__":
    main()
