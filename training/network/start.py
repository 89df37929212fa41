"""Start a training from the weights of another run or of a packaged model."""

from pathlib import Path

import onnx
import torch
from onnx import numpy_helper
from torch import Tensor

from crfnet_core.files import file_sha256
from training.network.model import PhotographNet

#: In front of the names of the parameters in the graph of a packaged model.
GRAPH_PREFIX = "net."

#: Suffix of the name under which the graph of a packaged model keeps a matrix in half precision.
HALF_SUFFIX = "_half"


def start_from(net: PhotographNet, source: Path) -> None:
    """Copy the weights of a checkpoint or of a model folder into the network, in place, as far as it has them."""
    net.load_state_dict(read_weights(net, source), strict=False)


def read_weights(net: PhotographNet, source: Path) -> dict[str, Tensor]:
    """Return the weights of a checkpoint or of a model folder; SystemExit if the folder's network is not like `net`."""
    file = _weights_file(source)
    return dict(torch.load(file, weights_only=True)["network"]) if file == source else _packaged_state(net, file)


def start_record(source: Path | None) -> str:
    """Return in words what a run starts from."""
    if source is None:
        return "random weights"
    file = _weights_file(source)
    name = file.name if file == source else f"{source.name}/{file.name}"
    return f"{name}, SHA-256 {file_sha256(file)}"


def _weights_file(source: Path) -> Path:
    return source / "model.onnx" if source.is_dir() else source


def _packaged_state(net: PhotographNet, graph: Path) -> dict[str, Tensor]:
    """Return the parameters in a graph; the export transposed some, and their shapes stand for the lost names."""
    tensors = {
        tensor.name.removesuffix(HALF_SUFFIX): torch.from_numpy(numpy_helper.to_array(tensor).astype("float32"))
        for tensor in onnx.load(graph).graph.initializer
    }
    state = {}
    for name, parameter in net.named_parameters():
        shape = tuple(parameter.shape)
        candidates = [tensor for key, tensor in tensors.items() if key == GRAPH_PREFIX + name and tensor.shape == shape]
        candidates = candidates or [
            tensor.T for tensor in tensors.values() if tensor.ndim == 2 and tensor.shape == shape[::-1]
        ]
        if len(candidates) != 1:
            raise SystemExit(f"{graph}: is not a network of this kind and size: it holds {len(candidates)} of {name}")
        state[name] = candidates[0]
    for name, buffer in net.named_buffers():
        if GRAPH_PREFIX + name in tensors and buffer.is_floating_point():
            state[name] = tensors[GRAPH_PREFIX + name]
    return state
