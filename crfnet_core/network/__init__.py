"""The trained network: its folder, and windows to evidence.

model        a model folder: its two files, and the entries of model.json
session      the graph in onnxruntime, its outputs checked
inference    the network itself: windows in, evidence out
pooling      the paper's way from the windows' evidence to a photograph's, for a network that does not pool by itself
runtime      onnxruntime, imported with its telemetry switched off
"""

from crfnet_core.network.inference import Predictions, ResponseNetwork
from crfnet_core.network.model import DEFAULT_MODEL, MODELS, ModelConfig, model_folder, packaged_models

__all__ = ["DEFAULT_MODEL", "MODELS", "ModelConfig", "Predictions", "ResponseNetwork", "model_folder"]
__all__ += ["packaged_models"]
