"""Train the paper's network: ``python -m training.crfnet2017.train --data DATA --run DIR --stage classify``.

Two stages (CRF-net paper, Sec. 3.3): to tell the 201 responses of DoRF apart and then, from those weights, to estimate
11 EMoR weights. The same command goes on with an interrupted run.
"""

import argparse
import math
import time
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np
import torch
from torch import Tensor, nn
from tqdm import tqdm

from crfnet_core.files import atomic_write
from crfnet_core.response.emor import COMPONENTS, EmorBasis
from training.crfnet2017.network import CRFNet
from training.crfnet2017.recipes import RECIPES, Recipe, make_optimizer
from training.crfnet2017.windows import TrainingScenes, Windows, draw_windows, read_splits
from training.data.manifest import training_digest
from training.provenance import record_run
from training.state import TrainingState, moving_average

#: Validation windows, the seed that makes them the same for every run, and how many run at once.
VALIDATION_WINDOWS, VALIDATION_SEED, VALIDATION_BATCH = 2000, 2017, 25

#: Steps between validations, and seconds between checkpoints where no validation comes before.
VALIDATE_EVERY, CHECKPOINT_SECONDS = 500, 300.0


@dataclass(frozen=True)
class RunConfig:
    """The configuration of a run; a run goes on only with the same."""

    stage: str  # "classify" or "regress"
    recipe: Recipe
    seed: int = 1  # of the initial weights and, with the step, of the windows
    init: str = "none"  # a run or a checkpoint whose weights the run starts from, or "none"


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
        return (outputs - self.weights[classes]).square().sum(dim=1)


@dataclass
class Trainer:
    """One stage of the training, from where `state` stands."""

    config: RunConfig
    task: StageTask
    state: TrainingState
    scenes: TrainingScenes
    validation: Windows

    def run(self, folder: Path) -> None:
        """Do the steps; validate, log and save. The windows of a step depend on the seed and the step only."""
        state, recipe, losses, saved = self.state, self.config.recipe, list[Tensor](), time.monotonic()
        steps = range(state.done, recipe.steps)
        for step in tqdm(steps, desc=self.config.stage, unit="step", initial=state.done, total=recipe.steps):
            seed = self.config.seed * 10**9 + step
            losses.append(self.step(draw_windows(self.scenes, recipe.batch, seed=seed, augment=recipe.augmented)))
            if state.done % VALIDATE_EVERY == 0 or state.done == recipe.steps:
                self._validate(folder, float(torch.stack(losses).mean()))
                losses.clear()
            elif time.monotonic() - saved < CHECKPOINT_SECONDS:
                continue
            state.save(folder / "last.pt")
            saved = time.monotonic()

    def step(self, batch: Windows) -> Tensor:
        """Move the weights once and return the loss."""
        recipe = self.config.recipe
        self.state.network.train()
        (inputs,) = batch.inputs(recipe.batch)
        loss = self.task.loss(self._outputs(self.state.network, inputs), batch.classes)
        self.state.move(loss, clip=recipe.clip)
        self.state.done += 1
        return loss.detach()

    def _outputs(self, network: nn.Module, inputs: Tensor) -> Tensor:
        with torch.autocast(inputs.device.type, torch.bfloat16, enabled=self.config.recipe.mixed):
            outputs: Tensor = network(inputs)
        return outputs.float()

    def _validate(self, folder: Path, loss: float) -> None:
        """Log the mean figure of the held-out windows by the average, and save the best average."""
        network, rows = self.state.averaged.module.eval(), self.state.rows
        with torch.inference_mode():
            outputs = torch.cat([self._outputs(network, part) for part in self.validation.inputs(VALIDATION_BATCH)])
        figure = float(self.task.figures(outputs, self.validation.classes).mean())
        is_better = self.task.is_better(figure, [row[2] for row in rows])
        rows.append([self.state.done, loss, figure])
        if is_better:
            self.state.save(folder / "best.pt")
        header, formats = "step,train_loss,validation", ("%d", "%.4f", "%.4f")
        with atomic_write(folder / "log.csv", overwrite=True) as temporary:
            np.savetxt(temporary, rows, formats, delimiter=",", header=header, comments="")


def train(scenes: TrainingScenes, validation: Windows, run: Path, config: RunConfig, *, digest: str) -> TrainingState:
    """Train until the last step, resuming what `run` holds, and return where the run stands.

    The device is the scenes'. The folder `run` gets run.json, log.csv, last.pt and best.pt. `digest` identifies the
    data. Raise SystemExit if `run` holds a run with another configuration or other data.
    """
    start = "random weights" if config.init == "none" else config.init
    record_run(run, recipe=asdict(config), seed=config.seed, data={"sha256": digest}, start=start)
    task = StageTask(config.stage, scenes.curves, squared=config.recipe.squared)
    state = _start(config, task, run / "last.pt")
    Trainer(config, task, state, scenes, validation).run(run)
    return state


def start_from(network: CRFNet, source: Path) -> None:
    """Copy the weights of a run or a checkpoint into the network; a last layer with other outputs stays as it is."""
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
    state = TrainingState(network, averaged, *make_optimizer(network, config.recipe))
    if last.exists():
        state.resume(last, task.weights.device)
    return state


def validation_windows(scenes: TrainingScenes) -> Windows:
    """Return the windows of the validation scenes that every run is judged by, the same on one kind of device."""
    return draw_windows(scenes, VALIDATION_WINDOWS, seed=VALIDATION_SEED)


def main() -> None:
    """Train as the options say."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--data", type=Path, required=True, help="folder with dorf and linear")
    parser.add_argument("--run", type=Path, required=True, help="folder of the checkpoints and the log")
    parser.add_argument("--stage", choices=RECIPES["default"], required=True)
    parser.add_argument("--recipe", choices=RECIPES, default="default")
    parser.add_argument("--init", default="none", help="a run or a checkpoint to start from; or none")
    parser.add_argument("--steps", type=int, help="other than the recipe's")
    parser.add_argument("--float32", action="store_true", help="faster on processors without AVX-512 (/proc/cpuinfo)")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--device", default="cuda" if torch.cuda.is_available() else "cpu", help="as torch names it")
    options = parser.parse_args()
    recipe = RECIPES[options.recipe][options.stage]
    recipe = replace(recipe, steps=options.steps or recipe.steps, mixed=recipe.mixed and not options.float32)
    config = RunConfig(options.stage, recipe, options.seed, options.init)
    splits = read_splits(options.data, options.device)
    validation, digest = validation_windows(splits["validation"]), training_digest(options.data)
    train(splits["train"], validation, options.run, config, digest=digest)
    print((options.run / "log.csv").read_text(), end="")


if __name__ == "__main__":
    main()
