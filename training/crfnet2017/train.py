"""Train the paper's network: ``python -m training.crfnet2017.train --data-pack DIR --run DIR --stage classify``.

Two stages (Sec. 3.4): to tell the 201 responses of DoRF apart, then, from those weights, to estimate 11 EMoR weights.
``torchrun`` starts the same command on several processes or GPUs; the checkpoint of one goes on on any number.
"""

from __future__ import annotations

import argparse
import json
import os
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import torch
import torch.distributed
from torch import Tensor, nn
from torch.nn.parallel import DistributedDataParallel
from torch.utils.data import DataLoader
from tqdm import tqdm

from crfnet_core.files import atomic_write_text
from training.crfnet2017.checkpoints import Progress, start_from
from training.crfnet2017.network import CRFNet
from training.crfnet2017.pack import ScenePack, read_pack
from training.crfnet2017.recipes import RECIPES, RunConfig, learning_rate, make_optimizer
from training.crfnet2017.runlog import Clock, draw_log, write_log
from training.crfnet2017.stages import STAGES, StageTask
from training.crfnet2017.windows import LinearWindows, WindowStream, draw_windows, render_windows

#: Validation windows, the same for every run on a pack, and how many go through the network at once.
VALIDATION_WINDOWS, VALIDATION_BATCH = 400, 25

#: Training windows that give the normalisations of a model folder their statistics back.
STATISTICS_WINDOWS = 32

#: Seconds between checkpoints where no validation comes before.
CHECKPOINT_SECONDS = 300.0

#: Seconds between changes of the progress bar; its lines also end up in the logs of unattended runs.
BAR_SECONDS = 5.0


@dataclass(frozen=True)
class Place:
    """Where a process computes: its device, its number and how many there are."""

    device: torch.device
    rank: int = 0
    processes: int = 1

    @property
    def leads(self) -> bool:
        """Whether this process writes."""
        return self.rank == 0


def join_processes() -> Place:
    """Return this process's place among those that torchrun started; alone without it."""
    gpu = torch.cuda.is_available()
    if "WORLD_SIZE" not in os.environ:
        return Place(torch.device("cuda" if gpu else "cpu"))
    device = torch.device("cuda", int(os.environ["LOCAL_RANK"])) if gpu else torch.device("cpu")
    if gpu:
        torch.cuda.set_device(device)
    if not torch.distributed.is_initialized():
        torch.distributed.init_process_group("nccl" if gpu else "gloo")
    return Place(device, torch.distributed.get_rank(), torch.distributed.get_world_size())


def train(
    pack: Path,
    run: Path,
    config: RunConfig,
    *,
    workers: int = 0,
    stop: int | None = None,
    validation_windows: int = VALIDATION_WINDOWS,
) -> Progress:
    """Train until the last step, resuming what `run` holds, and return where the run stands.

    Parameters
    ----------
    pack : Path
        Folder written by `training.crfnet2017.windows`.
    run : Path
        Folder of config.json, log.csv, curves.png and the checkpoints last.pt and best.pt.
    config : RunConfig
        What to do.
    workers : int
        Processes that draw windows; 0 draws them between the steps.
    stop : int, optional
        A step before the last to stop at, with a checkpoint.
    validation_windows : int
        Held-out windows.

    Raises
    ------
    SystemExit
        If `run` holds a run with another configuration.
    """
    place = join_processes()
    scenes, held_out = read_pack(pack, "train"), read_pack(pack, "validation")
    _claim(run, config, place)
    task = StageTask(config.stage, scenes.curves, squared=config.recipe.squared, device=place.device)
    progress = _start(config, task, scenes, place, run / "last.pt")
    validation = draw_windows(held_out, validation_windows, np.random.default_rng(2017))
    trainer = Trainer(config, task, progress, place, scenes, validation)
    trainer.run(run, range(progress.step, min(config.steps, stop or config.steps)), workers)
    return progress


class Trainer:
    """One stage on one process.

    Parameters
    ----------
    config, task, progress, place
        What to do, the stage, where the run stands, and where this process computes.
    scenes : ScenePack
        What to draw the training windows from.
    validation : LinearWindows
        The held-out windows.
    """

    def __init__(
        self,
        config: RunConfig,
        task: StageTask,
        progress: Progress,
        place: Place,
        scenes: ScenePack,
        validation: LinearWindows,
    ) -> None:
        self.config, self.task, self.progress, self.place = config, task, progress, place
        self.scenes, self.validation = scenes, validation
        self.curves = torch.from_numpy(scenes.curves).to(place.device)
        self.network: nn.Module = progress.network
        if place.processes > 1:
            self.network = DistributedDataParallel(progress.network)

    def run(self, folder: Path, steps: range, workers: int) -> None:
        """Do the steps; validate, log and save on the first process."""
        progress, leads, clock = self.progress, self.place.leads, Clock()
        batches = self._batches(steps, workers)
        names = {"desc": self.config.stage, "unit": "step", "initial": steps.start, "total": self.config.steps}
        bar = tqdm(steps, disable=not leads, mininterval=BAR_SECONDS, **names)
        for step in bar:
            with clock.waiting():
                batch = next(batches)
            clock.add(self.step(batch), len(batch.classes) * self.place.processes)
            if leads and progress.step % 10 == 0:
                newest = f"{progress.figures[-1]:.3f}" if progress.rows else "-"
                bar.set_postfix_str(f"loss {clock.loss:.3f}, validation {newest}, waiting {clock.share:.1%}")
            if leads and (progress.step % self.config.validate_every == 0 or progress.step == self.config.steps):
                self._validate(folder, clock)
            elif leads and (clock.since_saved > CHECKPOINT_SECONDS or step == steps[-1]):
                progress.save(folder / "last.pt")
                clock.saved()

    def step(self, batch: LinearWindows) -> Tensor:
        """Move the weights once and return the loss."""
        recipe, optimizer = self.config.recipe, self.progress.optimizer
        for group in optimizer.param_groups:
            group["lr"] = learning_rate(recipe, self.progress.step, self.config.steps) * group["factor"]
        self.network.train()
        batch = batch.to(self.place.device)
        loss = self.task.loss(self._outputs(self.network, batch), batch.classes)
        optimizer.zero_grad()
        loss.backward()
        if recipe.clip:
            nn.utils.clip_grad_norm_(self.network.parameters(), recipe.clip)
        optimizer.step()
        self.progress.step += 1
        return loss.detach()

    def validation_figure(self) -> float:
        """Return the mean figure of the held-out windows: top-1 accuracy, or E_est."""
        network = self.progress.network.eval()
        found = []
        with torch.inference_mode():
            for batch in self.validation.split(VALIDATION_BATCH):
                batch = batch.to(self.place.device)
                found.append(self.task.figures(self._outputs(network, batch), batch.classes))
        return float(torch.cat(found).mean())

    def _outputs(self, network: nn.Module, batch: LinearWindows) -> Tensor:
        """Return the network's outputs for a batch on its device."""
        windows = render_windows(batch, self.curves)
        order = torch.channels_last if self.config.recipe.channels_last else torch.contiguous_format
        with torch.autocast(self.place.device.type, torch.bfloat16, enabled=self.config.recipe.mixed):
            outputs: Tensor = network(windows.contiguous(memory_format=order))
        return outputs.float()

    def _batches(self, steps: range, workers: int) -> Iterator[LinearWindows]:
        """Return the windows of the steps in their order."""
        stream = WindowStream(
            self.scenes,
            batch=self.config.recipe.batch,
            steps=steps,
            seed=self.config.seed,
            rank=self.place.rank,
            per_photograph=self.config.per_photograph,
        )
        pinned = self.place.device.type == "cuda"
        return iter(DataLoader(stream, batch_size=None, num_workers=workers, pin_memory=pinned))

    def _validate(self, folder: Path, clock: Clock) -> None:
        """Log a validation and save; the other processes wait for this one in their next step."""
        progress = self.progress
        loss, speed, share = clock.loss, clock.speed, clock.share
        figure = self.validation_figure()
        better = self.task.is_better(figure, progress.figures)
        progress.rows.append([progress.step, loss, figure, speed, share])
        if better:
            progress.save_best(folder / "best.pt")
        progress.save(folder / "last.pt")
        write_log(folder / "log.csv", progress.rows)
        draw_log(folder / "curves.png", progress.rows, classifies=self.task.classifies)
        clock.saved()
        clock.restart()


def _claim(run: Path, config: RunConfig, place: Place) -> None:
    """Write config.json, or refuse a folder that belongs to another run."""
    entries: dict[str, Any] = json.loads(json.dumps(asdict(config)))
    path = run / "config.json"
    if path.exists():
        found = json.loads(path.read_text())
        differing = sorted(name for name in entries if found.get(name) != entries[name])
        if differing:
            raise SystemExit(f"{run}: holds a run of another {', '.join(differing)}; take another folder")
    elif place.leads:
        run.mkdir(parents=True, exist_ok=True)
        atomic_write_text(path, json.dumps(entries, indent=2) + "\n")


def _start(config: RunConfig, task: StageTask, scenes: ScenePack, place: Place, last: Path) -> Progress:
    """Return the network and its optimizer where the checkpoint `last` left them, or before the first step."""
    torch.manual_seed(config.seed)
    network = CRFNet(task.outputs)
    if config.init != "none" and not last.exists():
        windows = draw_windows(scenes, STATISTICS_WINDOWS, np.random.default_rng([config.seed, 2017]))
        start_from(network, Path(config.init), render_windows(windows, torch.from_numpy(scenes.curves)))
    order = torch.channels_last if config.recipe.channels_last else torch.contiguous_format
    network = network.to(place.device, memory_format=order)
    progress = Progress(network, make_optimizer(network, config.recipe))
    if last.exists():
        progress.resume(last, place.device)
    return progress


def _options() -> argparse.ArgumentParser:
    """Return the parser of the command line."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--data-pack", type=Path, required=True, help="folder written by training.crfnet2017.windows")
    parser.add_argument("--run", type=Path, required=True, help="folder of the checkpoints and the log")
    parser.add_argument("--stage", choices=STAGES, required=True)
    parser.add_argument("--recipe", choices=RECIPES, default="default")
    parser.add_argument("--init", default="none", help="a run, a checkpoint or a model folder to start from; or none")
    parser.add_argument("--steps", type=int, default=20_000)
    parser.add_argument("--learning-rate", type=float, help="other than the recipe's")
    parser.add_argument("--head-factor", type=float, help="other than the recipe's")
    parser.add_argument("--batch", type=int, help="other than the recipe's")
    parser.add_argument("--validate-every", type=int, default=500, help="steps")
    parser.add_argument("--per-photograph", type=int, default=1, help="windows of one photograph; the paper takes 10")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--threads", type=int, default=1, help="of torch, in each process")
    parser.add_argument("--workers", type=int, default=0, help="processes that draw windows; for GPUs")
    return parser


def main() -> None:
    """Train as the options say."""
    options = _options().parse_args()
    torch.set_num_threads(options.threads)
    changes = {name: getattr(options, name) for name in ("learning_rate", "head_factor", "batch")}
    recipe = replace(RECIPES[options.recipe], **{name: value for name, value in changes.items() if value is not None})
    names = ("stage", "steps", "seed", "init", "validate_every", "per_photograph")
    config = RunConfig(recipe=recipe, **{name: getattr(options, name) for name in names})
    train(options.data_pack, options.run, config, workers=options.workers)
    if torch.distributed.is_initialized():
        torch.distributed.destroy_process_group()
    if int(os.environ.get("RANK", "0")) == 0:
        print((options.run / "log.csv").read_text(), end="")


if __name__ == "__main__":
    main()
