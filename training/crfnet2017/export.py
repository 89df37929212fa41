"""Turn a run of the regression into a model folder: ``python -m training.crfnet2017.export --run DIR --data DIR ...``.

The steps are as in `training.export.model_folder`. The paper's network states no uncertainty, so what its answers
are worth as evidence is fitted on photographs of the validation scenes: see `training.crfnet2017.likelihood`.
"""

from __future__ import annotations

from pathlib import Path

import torch
from torch import Tensor, nn

from crfnet_core.posterior import UNUSUAL
from crfnet_core.posterior.evidence import EVIDENCE_WEIGHTS
from training.crfnet2017.likelihood import Likelihood, fit, validation_answers
from training.crfnet2017.network import CRFNet
from training.export.golden import golden_windows
from training.export.model_folder import export_options, write_model
from training.export.onnx_graph import WINDOWED, rounded


class WindowAnswers(nn.Module):
    """Windows of shape (N, 227, 227, 3) in [0, 1] to EMoR weights (N, 11)."""

    def __init__(self, network: CRFNet) -> None:
        super().__init__()
        self.network = network

    def forward(self, windows: Tensor) -> Tensor:
        """Return the answers of the network for each window."""
        answers: Tensor = self.network(windows.permute(0, 3, 1, 2))
        return answers


class ShippedCRFNet(nn.Module):
    """The network as the product runs it: its answers as evidence.

    likelihood: what its answers are worth
    """

    def __init__(self, answers: WindowAnswers, likelihood: Likelihood) -> None:
        super().__init__()
        self.answers = answers
        for name in ("slopes", "intercepts", "factor"):
            self.register_buffer(name, torch.from_numpy(getattr(likelihood, name)).float())
        self.log_odds = likelihood.log_odds

    def forward(self, windows: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """Return the evidence of windows, shape (N, 227, 227, 3) in [0, 1]."""
        locations = (self.answers(windows)[:, :EVIDENCE_WEIGHTS] - self.intercepts) / self.slopes
        factors = self.factor.expand(windows.shape[0], -1, -1)
        return locations, factors, locations[:, : len(UNUSUAL)] * 0 + self.log_odds


def load_network(run: Path) -> WindowAnswers:
    """Return the best network of a run, ready to infer, with its normalizations folded.

    Raise SystemExit if the run is of the first stage, which classifies responses.
    """
    state = torch.load(run / "best.pt", map_location="cpu", weights_only=True)
    network = CRFNet()
    if state["network"]["head.weight"].shape != network.head.weight.shape:
        raise SystemExit(f"{run}: is a run of the stage classify; export one of the stage regress")
    network.load_state_dict(state["network"])
    return WindowAnswers(fold_normalization(network)).eval()


def fold_normalization(network: CRFNet) -> CRFNet:
    """Return the network itself, ready to infer, with each normalization folded into the convolution before it."""
    network.eval()
    for layers in [module for module in network.modules() if isinstance(module, nn.Sequential)]:
        for index, layer in enumerate(layers):
            if isinstance(layer, nn.BatchNorm2d):
                layers[index - 1] = nn.utils.fuse_conv_bn_eval(layers[index - 1], layer)
                layers[index] = nn.Identity()
    return network


def cost_of_rounding(network: WindowAnswers) -> float:
    """Return the largest change of a weight (units of E_est) on the golden windows when the network is `rounded`.

    The network stays rounded.
    """
    windows = torch.from_numpy(golden_windows())
    with torch.inference_mode():
        before = network(windows)
        return float((rounded(network)(windows) - before).abs().max())


def main() -> None:
    """Export the best network of a run."""
    parser = export_options((__doc__ or "").splitlines()[0])
    parser.add_argument("--data", type=Path, required=True, help="folder with dorf, camera_curves and linear")
    options = parser.parse_args()
    network = load_network(options.run)
    print(f"half precision moves the weights by at most {cost_of_rounding(network):.1e}")
    likelihood = fit(*validation_answers(network, options.data))
    write_model(ShippedCRFNet(network, likelihood).eval(), WINDOWED, options)


if __name__ == "__main__":
    main()
