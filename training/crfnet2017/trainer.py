"""One stage of the training, on one process of those that train together."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import torch
import torch.distributed
from torch import Tensor, nn
from torch.nn.parallel import DistributedDataParallel
from torch.utils.data import DataLoader
from tqdm import tqdm

from training.crfnet2017.checkpoints import TrainingState
from training.crfnet2017.pack import ScenePack
from training.crfnet2017.recipes import RunConfig, learning_rate
from training.crfnet2017.runlog import Clock, draw_log, write_log
from training.crfnet2017.stages import StageTask
from training.crfnet2017.windows import LinearWindows, WindowStream, render_windows

#: Validation windows that go through the network at once.
VALIDATION_BATCH = 25

#: Seconds between checkpoints where no validation comes before.
CHECKPOINT_SECONDS = 300.0

#: Seconds between changes of the progress bar; its lines also end up in the logs of unattended runs.
BAR_SECONDS = 5.0


@dataclass(frozen=True)
class ProcessContext:
    """Where a process computes.

    rank, processes: its number among the processes that train together, and how many they are
    """

    device: torch.device
    rank: int = 0
    processes: int = 1

    @property
    def leads(self) -> bool:
        """Whether this process writes."""
        return self.rank == 0


def join_processes() -> ProcessContext:
    """Return the context of this process among those that torchrun started; without torchrun it is the only one."""
    gpu = torch.cuda.is_available()
    if "WORLD_SIZE" not in os.environ:
        return ProcessContext(torch.device("cuda" if gpu else "cpu"))
    device = torch.device("cuda", int(os.environ["LOCAL_RANK"])) if gpu else torch.device("cpu")
    if gpu:
        torch.cuda.set_device(device)
    if not torch.distributed.is_initialized():
        torch.distributed.init_process_group("nccl" if gpu else "gloo")
    return ProcessContext(device, torch.distributed.get_rank(), torch.distributed.get_world_size())


class Trainer:
    """One stage of the training on one process.

    config, task, state, context: the configuration, the stage, where the run stands, and where this process computes
    validation: the held-out windows
    """

    def __init__(
        self,
        config: RunConfig,
        task: StageTask,
        state: TrainingState,
        context: ProcessContext,
        scenes: ScenePack,
        validation: LinearWindows,
    ) -> None:
        self.config, self.task, self.state, self.context = config, task, state, context
        self.scenes, self.validation = scenes, validation
        self.curves = torch.from_numpy(scenes.curves).to(context.device)
        self.network: nn.Module = state.network
        if context.processes > 1:
            self.network = DistributedDataParallel(state.network)

    def run(self, folder: Path, steps: range, workers: int) -> None:
        """Do the steps; validate, log and save on the first process."""
        state, leads, clock = self.state, self.context.leads, Clock()
        batches = self._batches(steps, workers)
        names = {"desc": self.config.stage, "unit": "step", "initial": steps.start, "total": self.config.steps}
        bar = tqdm(steps, disable=not leads, mininterval=BAR_SECONDS, **names)
        for step in bar:
            with clock.waiting():
                batch = next(batches)
            clock.add(self.step(batch), len(batch.classes) * self.context.processes)
            if leads and state.step % 10 == 0:
                newest = f"{state.figures[-1]:.3f}" if state.rows else "-"
                bar.set_postfix_str(f"loss {clock.loss:.3f}, validation {newest}, waiting {clock.waiting_fraction:.1%}")
            if leads and (state.step % self.config.validate_every == 0 or state.step == self.config.steps):
                self._validate(folder, clock)
            elif leads and (clock.since_saved > CHECKPOINT_SECONDS or step == steps[-1]):
                state.save(folder / "last.pt")
                clock.saved()

    def step(self, batch: LinearWindows) -> Tensor:
        """Move the weights once and return the loss."""
        recipe, optimizer = self.config.recipe, self.state.optimizer
        for group in optimizer.param_groups:
            group["lr"] = learning_rate(recipe, self.state.step, self.config.steps) * group["factor"]
        self.network.train()
        batch = batch.to(self.context.device)
        loss = self.task.loss(self._outputs(self.network, batch), batch.classes)
        optimizer.zero_grad()
        loss.backward()
        if recipe.clip:
            nn.utils.clip_grad_norm_(self.network.parameters(), recipe.clip)
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
                batch = batch.to(self.context.device)
                figures.append(self.task.figures(self._outputs(network, batch), batch.classes))
        return float(torch.cat(figures).mean())

    def _outputs(self, network: nn.Module, batch: LinearWindows) -> Tensor:
        """Return the network's outputs for a batch on its device."""
        windows = render_windows(batch, self.curves)
        order = torch.channels_last if self.config.recipe.channels_last else torch.contiguous_format
        with torch.autocast(self.context.device.type, torch.bfloat16, enabled=self.config.recipe.mixed):
            outputs: Tensor = network(windows.contiguous(memory_format=order))
        return outputs.float()

    def _batches(self, steps: range, workers: int) -> Iterator[LinearWindows]:
        """Return the windows of the steps in their order."""
        stream = WindowStream(
            self.scenes,
            batch=self.config.recipe.batch,
            steps=steps,
            seed=self.config.seed,
            rank=self.context.rank,
            per_photograph=self.config.per_photograph,
        )
        pinned = self.context.device.type == "cuda"
        return iter(DataLoader(stream, batch_size=None, num_workers=workers, pin_memory=pinned))

    def _validate(self, folder: Path, clock: Clock) -> None:
        """Log a validation and save; the other processes wait for this one in their next step."""
        state = self.state
        loss, speed, waiting = clock.loss, clock.speed, clock.waiting_fraction
        figure = self.validation_figure()
        better = self.task.is_better(figure, state.figures)
        state.rows.append([state.step, loss, figure, speed, waiting])
        if better:
            state.save_best(folder / "best.pt")
        state.save(folder / "last.pt")
        write_log(folder / "log.csv", state.rows)
        draw_log(folder / "curves.png", state.rows, classifies=self.task.classifies)
        clock.saved()
        clock.restart()
