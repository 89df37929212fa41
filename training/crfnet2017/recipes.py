"""Recipes for the paper's network: optimizer, learning rate, batch and length of both stages."""

import math
from dataclasses import dataclass, replace

import torch
from torch.optim import Optimizer
from torch.optim.lr_scheduler import LambdaLR

from training.crfnet2017.network import CRFNet


@dataclass(frozen=True)
class Recipe:
    """How the weights of a stage are trained."""

    steps: int = 8_200  # steps of the whole stage
    optimizer: str = "adamw"  # "sgd" (with `momentum`) or "adamw"
    learning_rate: float = 1e-3  # the highest of the schedule
    #: Steps after which the learning rate falls to a tenth, again and again; 0 for one cycle: up for a tenth of the
    #: steps, down as a cosine to 0.
    step_size: int = 0
    #: Factor on the learning rate of the last layer, small because 270 848 inputs move each of its outputs together.
    head_factor: float = 0.001
    momentum: float = 0.9
    weight_decay: float = 0.02
    batch: int = 256  # windows of a step
    mixed: bool = True  # whether to compute in bfloat16 where that is safe
    clip: float = 1.0  # largest norm of the gradient; 0 for none
    #: Whether the loss of the regression is half the squared distance (Caffe's Euclidean loss), or the distance itself,
    #: which is E_est.
    squared: bool = False
    #: Steps that the moving average of the weights reaches back, exponentially; 1 for no average. A run is validated by
    #: the average and yields it.
    averaged_steps: float = 600.0
    augmented: bool = True  # whether the light of the windows is changed: see `training.crfnet2017.windows.augmented`


#: The first stage of the paper (Sec. 3.3): softmax loss over 201 responses, SGD with momentum, the learning policy
#: "step". It states no batch and no factor of this policy: 64 is assumed, and a tenth, which is Caffe's usual one.
PAPER = Recipe(
    steps=2_000_000,
    optimizer="sgd",
    learning_rate=0.01,
    step_size=500_000,
    head_factor=1.0,
    weight_decay=5e-4,
    batch=64,
    mixed=False,
    clip=0.0,
    squared=True,
    averaged_steps=1.0,
    augmented=False,
)

#: Name -> stage -> recipe. "default" is ours, for an accelerator: 2.1 million windows in each stage.
RECIPES = {
    "default": {"classify": Recipe(), "regress": Recipe()},
    "paper": {"classify": PAPER, "regress": replace(PAPER, learning_rate=1e-4, step_size=20_000, steps=25_000)},
}


def learning_rate(recipe: Recipe, step: int) -> float:
    """Return the learning rate of a step, counted from 0."""
    if recipe.step_size:
        return recipe.learning_rate * 0.1 ** (step // recipe.step_size)
    done = step / recipe.steps
    if done < 0.1:
        return recipe.learning_rate * (0.05 + 0.95 * done / 0.1)
    return recipe.learning_rate * 0.5 * (1 + math.cos(math.pi * (done - 0.1) / 0.9))


def make_optimizer(network: CRFNet, recipe: Recipe) -> tuple[Optimizer, LambdaLR]:
    """Return the optimizer of a recipe, with a group each for body and head, and the schedule of its learning rate."""
    groups = [
        {"params": list(network.body.parameters())},
        {"params": list(network.head.parameters()), "lr": recipe.learning_rate * recipe.head_factor},
    ]
    rate, decay = recipe.learning_rate, recipe.weight_decay
    if recipe.optimizer == "sgd":
        optimizer: Optimizer = torch.optim.SGD(groups, rate, recipe.momentum, weight_decay=decay)
    else:
        optimizer = torch.optim.AdamW(groups, rate, weight_decay=decay, fused=True)
    return optimizer, LambdaLR(optimizer, lambda step: learning_rate(recipe, step) / rate)
