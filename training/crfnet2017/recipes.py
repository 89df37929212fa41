"""Recipes for the paper's network: optimizer, learning rate, batch."""

from __future__ import annotations

import math
from dataclasses import dataclass

import torch

from training.crfnet2017.network import CRFNet


@dataclass(frozen=True)
class Recipe:
    """How the weights are trained.

    optimizer: "sgd" (with `momentum`) or "adamw"
    learning_rate: the highest learning rate of the schedule
    head_factor: factor on the learning rate of the last layer, small because 270 848 inputs move each of its outputs
        together
    momentum, weight_decay: of the optimizer
    batch: windows of a step on each process
    schedule: "steps" (a tenth after each third) or "one-cycle" (up for a tenth, down as a cosine to 0)
    mixed: whether to compute in bfloat16 where that is safe
    channels_last: whether the channels of a sample lie side by side in memory
    clip: largest norm of the gradient; 0 for none
    squared: whether the loss of the regression is half the squared distance (Caffe's Euclidean loss), or the distance
        itself, which is E_est
    averaged_steps: steps that the moving average of the weights reaches back, exponentially; 1 for no average. The
        average is what a run is validated by and yields, as in `training.network.train`.
    """

    optimizer: str = "adamw"
    learning_rate: float = 1e-3
    head_factor: float = 0.001
    momentum: float = 0.9
    weight_decay: float = 0.02
    batch: int = 16
    schedule: str = "one-cycle"
    mixed: bool = True
    channels_last: bool = True
    clip: float = 1.0
    squared: bool = False
    averaged_steps: float = 300.0


#: `default` is our recipe for few windows. `paper` is the paper's as far as we know it. We had a summary of its text,
#: which tells the two stages, their order and the Euclidean loss. The rest is assumed, as was usual with Caffe in 2017:
#: SGD, momentum 0.9, a learning rate of 0.01 that drops to a tenth after each third, weight decay 5e-4, batches of 64.
RECIPES = {
    "default": Recipe(),
    "paper": Recipe(
        optimizer="sgd",
        learning_rate=1e-2,
        head_factor=1.0,
        weight_decay=5e-4,
        batch=64,
        schedule="steps",
        mixed=False,
        channels_last=False,
        clip=0.0,
        squared=True,
        averaged_steps=1.0,
    ),
}


@dataclass(frozen=True)
class RunConfig:
    """The configuration of a run; a run goes on only with the same.

    stage: "classify" or "regress"
    seed: seed of the initial weights and, with the step, of the windows
    init: a run, a checkpoint or a model folder whose weights the run starts from, or "none"
    validate_every: steps between validations
    per_photograph: most windows of one photograph in a batch
    """

    stage: str
    recipe: Recipe
    steps: int
    seed: int = 1
    init: str = "none"
    validate_every: int = 500
    per_photograph: int = 1


def learning_rate(recipe: Recipe, step: int, steps: int) -> float:
    """Return the learning rate of a step, counted from 0, of `steps`."""
    done = step / steps
    if recipe.schedule == "steps":
        return recipe.learning_rate * 0.1 ** int(3 * done)
    if done < 0.1:
        return recipe.learning_rate * (0.05 + 0.95 * done / 0.1)
    return recipe.learning_rate * 0.5 * (1 + math.cos(math.pi * (done - 0.1) / 0.9))


def make_optimizer(network: CRFNet, recipe: Recipe) -> torch.optim.Optimizer:
    """Return the optimizer of a recipe, with a group each for body and head; "factor" is on the learning rate."""
    groups = [
        {"params": list(network.body.parameters()), "factor": 1.0},
        {"params": list(network.head.parameters()), "factor": recipe.head_factor},
    ]
    if recipe.optimizer == "sgd":
        return torch.optim.SGD(groups, recipe.learning_rate, recipe.momentum, weight_decay=recipe.weight_decay)
    return torch.optim.AdamW(groups, recipe.learning_rate, weight_decay=recipe.weight_decay, fused=True)
