"""Train the paper's network: ``python -m training.crfnet2017.train --data-pack DIR --run DIR --stage classify``.

Two stages (CRF-net paper, Sec. 3.4): to tell the 201 responses of DoRF apart and then, from those weights, to estimate
11 EMoR weights. ``torchrun`` starts the same command on several processes or GPUs; the checkpoint of one goes on on any
number.
"""

from __future__ import annotations

import argparse
import os
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import torch
import torch.distributed

from training.crfnet2017.checkpoints import TrainingState, start_from
from training.crfnet2017.network import CRFNet
from training.crfnet2017.pack import ScenePack, pack_files, read_pack
from training.crfnet2017.recipes import RECIPES, RunConfig, make_optimizer
from training.crfnet2017.stages import STAGES, StageTask
from training.crfnet2017.trainer import ProcessContext, Trainer, join_processes
from training.crfnet2017.windows import draw_windows, render_windows
from training.network.moving_average import moving_average
from training.provenance import data_record, record_run

#: Validation windows, the same for every run on a pack.
VALIDATION_WINDOWS = 2000

#: Training windows that give the normalizations of a model folder their statistics back.
STATISTICS_WINDOWS = 32


def train(
    pack: Path,
    run: Path,
    config: RunConfig,
    *,
    workers: int = 0,
    stop: int | None = None,
    validation_windows: int = VALIDATION_WINDOWS,
) -> TrainingState:
    """Train until the last step, resuming what `run` holds, and return where the run stands.

    `pack`: folder written by `training.crfnet2017.windows`. `run`: folder of run.json, log.csv, curves.png and the
    checkpoints last.pt and best.pt. `config`: the configuration of the run. `workers`: processes that draw windows; 0
    draws them between the steps. `stop`: a step before the last to stop at, with a checkpoint.
    `validation_windows`: held-out windows. Raise SystemExit if `run` holds a run with another configuration, or on
    another pack.
    """
    context = join_processes()
    scenes, held_out = read_pack(pack, "train"), read_pack(pack, "validation")
    if context.leads:
        start = "random weights" if config.init == "none" else config.init
        data = data_record(pack, pack_files(pack))
        record_run(run, recipe=asdict(config), seed=config.seed, data=data, start=start)
    task = StageTask(config.stage, scenes.curves, squared=config.recipe.squared, device=context.device)
    state = _start(config, task, scenes, context, run / "last.pt")
    validation = draw_windows(held_out, validation_windows, np.random.default_rng(2017))
    trainer = Trainer(config, task, state, context, scenes, validation)
    trainer.run(run, range(state.step, min(config.steps, stop or config.steps)), workers)
    return state


def _start(config: RunConfig, task: StageTask, scenes: ScenePack, context: ProcessContext, last: Path) -> TrainingState:
    """Return the network and its optimizer where the checkpoint `last` left them, or before the first step."""
    torch.manual_seed(config.seed)
    network = CRFNet(task.outputs)
    if config.init != "none" and not last.exists():
        windows = draw_windows(scenes, STATISTICS_WINDOWS, np.random.default_rng([config.seed, 2017]))
        start_from(network, Path(config.init), render_windows(windows, torch.from_numpy(scenes.curves)))
    order = torch.channels_last if config.recipe.channels_last else torch.contiguous_format
    network = network.to(context.device, memory_format=order)
    averaged = moving_average(network, config.recipe.averaged_steps)
    state = TrainingState(network, averaged, make_optimizer(network, config.recipe))
    if last.exists():
        state.resume(last, context.device)
    return state


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
    parser.add_argument(
        "--float32", action="store_true", help="no bfloat16: faster on processors without AVX-512 (see /proc/cpuinfo)"
    )
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
    recipe = replace(recipe, mixed=recipe.mixed and not options.float32)
    names = ("stage", "steps", "seed", "init", "validate_every", "per_photograph")
    config = RunConfig(recipe=recipe, **{name: getattr(options, name) for name in names})
    train(options.data_pack, options.run, config, workers=options.workers)
    if torch.distributed.is_initialized():
        torch.distributed.destroy_process_group()
    if int(os.environ.get("RANK", "0")) == 0:
        print((options.run / "log.csv").read_text(), end="")


if __name__ == "__main__":
    main()
