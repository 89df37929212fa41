"""What a trained network is, how it is run, and what its answers mean.

runtime      onnxruntime, imported with its telemetry switched off
model        a model folder: its files and what model.json says
inference    the network itself: windows to inputs, inputs to predictions
pooling      the paper's way from the windows' predictions to one, for a network that does not pool by itself
uncertainty  from the error that the network expects to the uncertainty, the band and the verdict
"""

from crfnet_core.network.inference import Answer, Predictions, ResponseNetwork
from crfnet_core.network.model import DEFAULT_MODEL, MODELS, ModelConfig, model_folder, packaged_models
from crfnet_core.network.uncertainty import UncertaintyModel, Verdict

__all__ = [
    "DEFAULT_MODEL",
    "MODELS",
    "Answer",
    "ModelConfig",
    "Predictions",
    "ResponseNetwork",
    "UncertaintyModel",
    "Verdict",
    "model_folder",
    "packaged_models",
]
