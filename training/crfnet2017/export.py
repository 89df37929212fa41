"""Turn a run of the regression into a model folder: ``python -m training.crfnet2017.export --run DIR --data DIR ...``.

The steps are those of `training.export.model_folder`. The paper's network expects no error of its own, so its log error
is a constant, that of the best mean E_est on the validation windows, and the uncertainty goes by the spread of the
windows' estimates.
"""

from __future__ import annotations

import math
from pathlib import Path

import torch
from torch import Tensor, nn

from training.crfnet2017.checkpoints import fold_normalization
from training.crfnet2017.network import CRFNet
from training.export.golden import golden_windows
from training.export.model_folder import export_options, write_model
from training.export.onnx_graph import WINDOWED, rounded


class ShippedCRFNet(nn.Module):
    """The network as the product runs it.

    Parameters
    ----------
    network : CRFNet
        With 11 outputs.
    expected_error : float
        The E_est that is expected of every window.
    """

    def __init__(self, network: CRFNet, expected_error: float) -> None:
        super().__init__()
        self.network = network
        self.register_buffer("log_error", torch.tensor([math.log(expected_error)]))

    def forward(self, windows: Tensor) -> tuple[Tensor, Tensor]:
        """Return EMoR weights (N, 11) and log errors (N,) of windows of shape (N, 227, 227, 3) in [0, 1]."""
        return self.network(windows.permute(0, 3, 1, 2)), self.log_error.expand(windows.shape[0])


def load_network(run: Path) -> ShippedCRFNet:
    """Return the best network of a run, ready to infer, with its normalisations folded.

    Raises
    ------
    SystemExit
        If the run is of the first stage, which tells responses apart.
    """
    state = torch.load(run / "best.pt", map_location="cpu", weights_only=True)
    network = CRFNet()
    if state["network"]["head.weight"].shape != network.head.weight.shape:
        raise SystemExit(f"{run}: is a run of the stage classify; export one of the stage regress")
    network.load_state_dict(state["network"])
    return ShippedCRFNet(fold_normalization(network), min(row[2] for row in state["rows"])).eval()


def cost_of_rounding(network: ShippedCRFNet) -> float:
    """Return the largest change of a weight (units of E_est) on the golden windows when the network is `rounded`.

    The network stays rounded.
    """
    windows = torch.from_numpy(golden_windows())
    with torch.inference_mode():
        before = network(windows)[0]
        return float((rounded(network)(windows)[0] - before).abs().max())


def main() -> None:
    """Export the best network of a run."""
    options = export_options((__doc__ or "").splitlines()[0]).parse_args()
    network = load_network(options.run)
    print(f"half precision moves the weights by at most {cost_of_rounding(network):.1e}")
    write_model(network, WINDOWED, options)


if __name__ == "__main__":
    main()
