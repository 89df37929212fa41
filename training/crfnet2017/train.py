"""Train the paper's network: ``python -m training.crfnet2017.train --data DATA --run DIR --stage classify``.

Two stages (CRF-net paper, Sec. 3.3): to tell the 201 responses of DoRF apart and then, from those weights, to estimate
11 EMoR weights. The same command goes on with an interrupted run.
"""

from __future__ import annotations

import argparse
import csv
import io
import time
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path

import numpy as np
import torch
from torch import Tensor, nn
from torch.optim.swa_utils import AveragedModel
from torch.utils.data import DataLoader
from tqdm import tqdm

from crfnet_core.files import atomic_write, atomic_write_text
from training.crfnet2017.network import CRFNet
from training.crfnet2017.recipes import RECIPES, Recipe, learning_rate, make_optimizer
from training.crfnet2017.stages import STAGES, StageTask
from training.crfnet2017.windows import (
    LinearWindows,
    TrainingScenes,
    WindowStream,
    draw_windows,
    read_splits,
    render_windows,
)
from training.data.manifest import training_digest
from training.network.moving_average import moving_average, resume_average
from training.provenance import record_run

#: Validation windows, the same for every run, and how many go through the network at once.
VALIDATION_WINDOWS, VALIDATION_BATCH = 2000, 25

#: Steps between validations, and seconds between checkpoints where no validation comes before.
VALIDATE_EVERY, CHECKPOINT_SECONDS = 500, 300.0

#: Columns of log.csv.
LOG_COLUMNS = ("step", "train_loss", "validation")


@dataclass(frozen=True)
class RunConfig:
    """The configuration of a run; a run goes on only with the same.

    stage: "classify" or "regress"
    seed: of the initial weights and, with the step, of the windows
    init: a run or a checkpoint whose weights the run starts from, or "none"
    """

    stage: str
    recipe: Recipe
    seed: int = 1
    init: str = "none"


@dataclass
class TrainingState:
    """All that a run needs to go on; `averaged` is the moving average of the network's weights, `rows` the log."""

    network: CRFNet
    averaged: AveragedModel
    optimizer: torch.optim.Optimizer
    step: int = 0
    rows: list[list[float]] = field(default_factory=list)

    def save(self, path: Path) -> None:
        """Write the checkpoint, whole or not at all; its "network" is the average, "moving" the weights that go on."""
        parts = {"network": self.averaged.module, "moving": self.network, "optimizer": self.optimizer}
        states = {name: part.state_dict() for name, part in parts.items()}
        with atomic_write(path, overwrite=True) as temporary:
            torch.save(states | {"step": self.step, "rows": self.rows}, temporary)

    def resume(self, path: Path, device: torch.device) -> None:
        """Go on from a checkpoint."""
        state = torch.load(path, map_location=device, weights_only=True)
        self.network.load_state_dict(state["moving"])
        resume_average(self.averaged, state["network"])
        self.optimizer.load_state_dict(state["optimizer"])
        self.step, self.rows = state["step"], state["rows"]


class Trainer:
    """One stage of the training, from where `state` stands."""

    def __init__(
        self,
        config: RunConfig,
        task: StageTask,
        state: TrainingState,
        scenes: TrainingScenes,
        validation: LinearWindows,
    ) -> None:
        self.config, self.task, self.state, self.scenes, self.validation = config, task, state, scenes, validation
        self.device = task.weights.device
        self.curves = torch.from_numpy(scenes.curves).to(self.device)

    def run(self, folder: Path, steps: range, workers: int) -> None:
        """Do the steps; validate, log and save."""
        state, recipe, losses, saved = self.state, self.config.recipe, list[Tensor](), time.monotonic()
        stream = WindowStream(self.scenes, batch=recipe.batch, steps=steps, seed=self.config.seed)
        batches = DataLoader(stream, batch_size=None, num_workers=workers)
        for batch in tqdm(batches, desc=self.config.stage, unit="step", initial=steps.start, total=recipe.steps):
            losses.append(self.step(batch))
            if state.step % VALIDATE_EVERY == 0 or state.step == recipe.steps:
                self._validate(folder, float(torch.stack(losses).mean()))
                losses.clear()
            elif time.monotonic() - saved < CHECKPOINT_SECONDS and state.step != steps.stop:
                continue
            state.save(folder / "last.pt")
            saved = time.monotonic()

    def step(self, batch: LinearWindows) -> Tensor:
        """Move the weights once and return the loss."""
        recipe, optimizer = self.config.recipe, self.state.optimizer
        for group in optimizer.param_groups:
            group["lr"] = learning_rate(recipe, self.state.step) * group["factor"]
        self.state.network.train()
        batch = batch.to(self.device)
        loss = self.task.loss(self._outputs(self.state.network, batch), batch.classes)
        optimizer.zero_grad()
        loss.backward()
        if recipe.clip:
            nn.utils.clip_grad_norm_(self.state.network.parameters(), recipe.clip)
        optimizer.step()
        self.state.averaged.update_parameters(self.state.network)
        self.state.step += 1
        return loss.detach()

    def validation_figure(self) -> float:
        """Return the mean figure of the held-out windows by the average: top-1 accuracy, or E_est."""
        network = self.state.averaged.module.eval()
        figures = []
        with torch.inference_mode():
            for batch in self.validation.split(VALIDATION_BATCH):
                batch = batch.to(self.device)
                figures.append(self.task.figures(self._outputs(network, batch), batch.classes))
        return float(torch.cat(figures).mean())

    def _outputs(self, network: nn.Module, batch: LinearWindows) -> Tensor:
        """Return the network's outputs for a batch on its device."""
        windows = render_windows(batch, self.curves).contiguous(memory_format=torch.channels_last)
        with torch.autocast(self.device.type, torch.bfloat16, enabled=self.config.recipe.mixed):
            outputs: Tensor = network(windows)
        return outputs.float()

    def _validate(self, folder: Path, loss: float) -> None:
        """Log a validation, and save the best average."""
        figure, rows = self.validation_figure(), self.state.rows
        is_better = self.task.is_better(figure, [row[2] for row in rows])
        rows.append([self.state.step, loss, figure])
        if is_better:
            self.state.save(folder / "best.pt")
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(LOG_COLUMNS)
        writer.writerows([int(step), *(f"{value:.4f}" for value in values)] for step, *values in rows)
        atomic_write_text(folder / "log.csv", text.getvalue(), overwrite=True)


def train(
    scenes: TrainingScenes,
    validation: LinearWindows,
    run: Path,
    config: RunConfig,
    *,
    digest: str,
    workers: int = 0,
    stop: int | None = None,
) -> TrainingState:
    """Train until the last step, or until `stop`, resuming what `run` holds, and return where the run stands.

    The folder `run` gets run.json, log.csv and the checkpoints last.pt and best.pt. `digest` identifies the data, and
    `workers` processes draw windows. Raise SystemExit if `run` holds a run with another configuration or other data.
    """
    device = torch.device("cuda" if torch.cuda.is_available() else "cpu")
    start = "random weights" if config.init == "none" else config.init
    record_run(run, recipe=asdict(config), seed=config.seed, data={"sha256": digest}, start=start)
    task = StageTask(config.stage, scenes.curves, squared=config.recipe.squared, device=device)
    state = _start(config, task, run / "last.pt")
    trainer = Trainer(config, task, state, scenes, validation)
    trainer.run(run, range(state.step, min(config.recipe.steps, stop or config.recipe.steps)), workers)
    return state


def start_from(network: CRFNet, source: Path) -> None:
    """Copy the weights of a run (its best checkpoint) or of a checkpoint into the network, in place.

    A last layer with another number of outputs stays as it is, as between the two stages.
    """
    path = source / "best.pt" if source.is_dir() else source
    state = torch.load(path, map_location="cpu", weights_only=True)["network"]
    if state["head.weight"].shape != network.head.weight.shape:
        state |= {f"head.{name}": parameter for name, parameter in network.head.state_dict().items()}
    network.load_state_dict(state)


def _start(config: RunConfig, task: StageTask, last: Path) -> TrainingState:
    """Return the network and its optimizer where the checkpoint `last` left them, or before the first step."""
    torch.manual_seed(config.seed)
    network = CRFNet(task.outputs)
    if config.init != "none" and not last.exists():
        start_from(network, Path(config.init))
    network = network.to(task.weights.device, memory_format=torch.channels_last)
    averaged = moving_average(network, config.recipe.averaged_steps)
    state = TrainingState(network, averaged, make_optimizer(network, config.recipe))
    if last.exists():
        state.resume(last, task.weights.device)
    return state


def main() -> None:
    """Train as the options say."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--data", type=Path, required=True, help="folder with dorf and linear")
    parser.add_argument("--run", type=Path, required=True, help="folder of the checkpoints and the log")
    parser.add_argument("--stage", choices=STAGES, required=True)
    parser.add_argument("--recipe", choices=RECIPES, default="default")
    parser.add_argument("--init", default="none", help="a run or a checkpoint to start from; or none")
    parser.add_argument("--steps", type=int, help="other than the recipe's")
    parser.add_argument("--float32", action="store_true", help="faster on processors without AVX-512 (/proc/cpuinfo)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--workers", type=int, default=0, help="processes that draw windows; for GPUs")
    options = parser.parse_args()
    recipe = RECIPES[options.recipe][options.stage]
    recipe = replace(recipe, steps=options.steps or recipe.steps, mixed=recipe.mixed and not options.float32)
    config = RunConfig(options.stage, recipe, options.seed, options.init)
    splits = read_splits(options.data)
    validation = draw_windows(splits["validation"], VALIDATION_WINDOWS, np.random.default_rng(2017))
    digest = training_digest(options.data)
    train(splits["train"], validation, options.run, config, digest=digest, workers=options.workers)
    print((options.run / "log.csv").read_text(), end="")


if __name__ == "__main__":
    main()
