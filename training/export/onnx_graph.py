"""From a PyTorch network to an ONNX graph with matrices in half precision."""

from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import numpy as np
import onnx
import torch
from onnx import TensorProto, helper, numpy_helper
from torch import nn

from crfnet_core.files import atomic_write
from crfnet_core.posterior.evidence import EVIDENCE_WEIGHTS
from crfnet_core.response.emor import COMPONENTS
from crfnet_core.statistics import LENGTH
from crfnet_core.statistics.windows import WINDOW_SIZE
from training.network.start import HALF_SUFFIX

OPSET = 18

Network = TypeVar("Network", bound=nn.Module)


@dataclass(frozen=True)
class Signature:
    """The input, with its shape for one window, and the outputs of a network: `crfnet_core.network.ModelConfig`.

    `weights` is the number of EMoR weights that its evidence is about.
    """

    input_name: str
    input_shape: tuple[int, ...]
    output_names: tuple[str, ...]
    weights: int = EVIDENCE_WEIGHTS


#: The parts of evidence, of every window and of all windows together.
OF_WINDOWS, POOLED = ("locations", "factors", "log_odds"), ("pooled_location", "pooled_factor", "pooled_log_odds")

#: A network that reads the statistics of windows and pools them.
POOLING = Signature("statistics", (LENGTH,), (*OF_WINDOWS, *POOLED))

#: A network that reads windows and answers for each by itself, with a whole response.
WINDOWED = Signature("windows", (WINDOW_SIZE, WINDOW_SIZE, 3), OF_WINDOWS, COMPONENTS)


def rounded(network: Network) -> Network:
    """Return the network itself, its matrices rounded to half precision in place."""
    with torch.no_grad():
        for parameter in network.parameters():
            if parameter.ndim > 1:
                parameter.copy_(parameter.half().float())
    return network


def export_onnx(network: nn.Module, signature: Signature, path: Path) -> None:
    """Write the graph of a `rounded` network, with a free number of windows and matrices in half precision."""
    program = torch.onnx.export(
        network,
        (torch.rand(2, *signature.input_shape),),
        input_names=[signature.input_name],
        output_names=list(signature.output_names),
        dynamic_shapes=({0: torch.export.Dim("windows")},),
        opset_version=OPSET,
        dynamo=True,
    )
    assert program is not None  # with dynamo=True
    model = program.model_proto
    store_in_half_precision(model.graph)
    with atomic_write(path, overwrite=True) as temporary:
        onnx.save(model, temporary)


def store_in_half_precision(graph: onnx.GraphProto) -> None:
    """Keep the matrices that half precision represents exactly in it, with a cast to single precision behind each."""
    for initializer in graph.initializer:
        values = numpy_helper.to_array(initializer)
        if values.dtype == np.float32 and values.ndim > 1 and (values == values.astype(np.float16)).all():
            name, half_name = initializer.name, f"{initializer.name}{HALF_SUFFIX}"
            initializer.CopyFrom(numpy_helper.from_array(values.astype(np.float16), half_name))
            graph.node.insert(0, helper.make_node("Cast", [half_name], [name], to=TensorProto.FLOAT))
