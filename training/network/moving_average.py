"""The moving average of the weights of a training, which is what a run yields (Polyak & Juditsky, 1992)."""

from torch import Tensor, nn
from torch.optim.swa_utils import AveragedModel, get_ema_multi_avg_fn


def moving_average(network: nn.Module, steps: float) -> AveragedModel:
    """Return the exponential average of a network's weights and of the statistics of its normalizations.

    `AveragedModel.update_parameters` takes the network after each step. The average reaches back over `steps`; with 1
    it is the network itself.
    """
    return AveragedModel(network, multi_avg_fn=get_ema_multi_avg_fn(1 - 1 / steps), use_buffers=True)


def resume_average(averaged: AveragedModel, weights: dict[str, Tensor]) -> None:
    """Go on, in place, from the weights of an average: the next step adds to them, and does not replace them."""
    averaged.module.load_state_dict(weights)
    averaged.n_averaged.fill_(1)
