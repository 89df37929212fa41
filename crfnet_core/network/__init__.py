"""What a trained network is and how it is run.

runtime      onnxruntime, imported with its telemetry switched off
model        a model folder: its files and what model.json says
graph        what a model.onnx may hold, looked at before it is loaded
session      the graph in onnxruntime, its inputs and outputs checked
inference    the network itself: windows to inputs, inputs to evidence
pooling      the paper's way from the windows' evidence to a photograph's, for a network that does not pool by itself
"""

from crfnet_core.network.inference import Predictions, ResponseNetwork
from crfnet_core.network.model import DEFAULT_MODEL, MODELS, ModelConfig, model_folder, packaged_models

__all__ = [
    "DEFAULT_MODEL",
    "MODELS",
    "ModelConfig",
    "Predictions",
    "ResponseNetwork",
    "model_folder",
    "packaged_models",
]
