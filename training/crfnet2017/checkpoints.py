"""Save and restore the state of a run, and start from the weights of another run or of a model folder."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import torch
from torch import Tensor, nn
from torch.optim.swa_utils import AveragedModel

from crfnet_core.files import atomic_write
from training.crfnet2017.network import CRFNet
from training.network.moving_average import resume_average
from training.network.start import graph_tensors

#: In front of the parameters' names in the graph of an exported network.
GRAPH_PREFIX = "answers.network."


@dataclass
class TrainingState:
    """All that a run needs to go on from where it stopped; what is random depends on the seed and the step only.

    network: the network itself, not wrapped for several processes, so that any number of them can go on
    rows: the log: step, training loss, validation figure, windows per second, fraction of the time spent waiting
    """

    network: CRFNet
    averaged: AveragedModel
    optimizer: torch.optim.Optimizer
    step: int = 0
    rows: list[list[float]] = field(default_factory=list)

    @property
    def figures(self) -> list[float]:
        """The validation figures so far."""
        return [row[2] for row in self.rows]

    def save(self, path: Path) -> None:
        """Write the checkpoint, whole or not at all; its "network" is the average, "moving" the weights that go on."""
        parts = {"network": self.averaged.module, "moving": self.network, "optimizer": self.optimizer}
        states = {name: part.state_dict() for name, part in parts.items()}
        _save(states | {"step": self.step, "rows": self.rows}, path)

    def save_best(self, path: Path) -> None:
        """Write the average and the log so far."""
        _save({"network": self.averaged.module.state_dict(), "step": self.step, "rows": self.rows}, path)

    def resume(self, path: Path, device: torch.device) -> None:
        """Go on from a checkpoint."""
        state = torch.load(path, map_location=device, weights_only=True)
        self.network.load_state_dict(state["moving"])
        resume_average(self.averaged, state["network"])
        self.optimizer.load_state_dict(state["optimizer"])
        self.step, self.rows = state["step"], state["rows"]


def start_from(network: CRFNet, source: Path, windows: Tensor) -> bool:
    """Copy the weights of another training into the network, in place.

    `network`: is changed. `source`: a run folder (its best checkpoint), a checkpoint, or a model folder written by
    `training.crfnet2017.export`. `windows`, (N, 3, 227, 227): training windows, at least a few; needed only for a model
    folder, whose normalizations are folded into the convolutions. The result: whether the last layer was copied too;
    one with another number of outputs stays as it is. Raise SystemExit if the source holds another network.
    """
    exported = (source / "model.onnx").exists()
    state = _exported_state(source / "model.onnx") if exported else _checkpoint_state(source)
    same_head = state["head.weight"].shape == network.head.weight.shape
    kept = state if same_head else {name: tensor for name, tensor in state.items() if not name.startswith("head.")}
    missing, unexpected = network.load_state_dict(kept, strict=False)
    missing = [name for name in missing if not name.startswith("head.") or same_head]
    if unexpected or (missing and not exported):
        raise SystemExit(f"{source}: is of another network: lacks {missing}, has {unexpected}")
    if exported:
        unfold_normalization(network, windows)
    return same_head


def fold_normalization(network: CRFNet) -> CRFNet:
    """Return the network itself, ready to infer, with each normalization folded into the convolution before it."""
    network.eval()
    for layers in _sequences(network):
        for index, layer in enumerate(layers):
            if isinstance(layer, nn.BatchNorm2d):
                layers[index - 1] = nn.utils.fuse_conv_bn_eval(layers[index - 1], layer)
                layers[index] = nn.Identity()
    return network


def unfold_normalization(network: CRFNet, windows: Tensor) -> None:
    """Give a folded network its normalizations back, in place, without changing its outputs.

    Folding loses the mean and the variance that a normalization needs in training; those of `windows` take their place.

    `network`: the biases of its normalizations are those of the folded convolutions (see `_exported_state`); their
    other parameters are as they were when the network was made. `windows`, (N, 3, 227, 227): the windows whose mean and
    variance are taken.
    """
    normalizations = [layer for layer in network.modules() if isinstance(layer, nn.BatchNorm2d)]
    hooks = [layer.register_forward_pre_hook(_take_statistics) for layer in normalizations]
    network.eval()
    with torch.inference_mode():
        network(windows)
    for hook in hooks:
        hook.remove()


def _take_statistics(layer: nn.Module, inputs: tuple[Tensor]) -> None:
    """Give a normalization the statistics of its input, and a scale and a bias that undo them, its own bias aside."""
    variance, mean = torch.var_mean(inputs[0], dim=(0, 2, 3), correction=0)
    layer.running_mean.copy_(mean)
    layer.running_var.copy_(variance)
    layer.weight.data.copy_((variance + layer.eps).sqrt())
    layer.bias.data.add_(mean)


def _checkpoint_state(source: Path) -> dict[str, Tensor]:
    """Return the network's state in a checkpoint or in the best one of a run."""
    path = source / "best.pt" if source.is_dir() else source
    state: dict[str, Tensor] = torch.load(path, map_location="cpu", weights_only=True)["network"]
    return state


def _exported_state(graph: Path) -> dict[str, Tensor]:
    """Return the parameters in an exported graph; the biases of convolutions become those of the normalizations."""
    tensors = graph_tensors(graph).items()
    state = {name.removeprefix(GRAPH_PREFIX): tensor for name, tensor in tensors if name.startswith(GRAPH_PREFIX)}
    for name in [name for name in state if name.endswith(".bias") and not name.startswith("head.")]:
        layers, index, _ = name.rsplit(".", 2)
        state[f"{layers}.{int(index) + 1}.bias"] = state.pop(name)
    state["body.0.bias"] = torch.zeros_like(state["body.1.bias"])
    return state


def _sequences(network: CRFNet) -> list[nn.Sequential]:
    """Return all sequences of layers."""
    return [module for module in network.modules() if isinstance(module, nn.Sequential)]


def _save(state: dict[str, object], path: Path) -> None:
    """Write a checkpoint."""
    with atomic_write(path, overwrite=True) as temporary:
        torch.save(state, temporary)
