"""Turn a run of the regression into a model folder: ``python -m training.crfnet2017.export --run DIR --data DIR ...``.

The steps are as in `training.export.model_folder`. The network answers with EMoR weights and no uncertainty; what an
answer is worth as evidence is the covariance of its errors on windows of the validation scenes.
"""

from pathlib import Path

import torch
from torch import Tensor, nn

from crfnet_core.posterior import UNUSUAL
from crfnet_core.posterior.evidence import DEGREES_OF_FREEDOM
from crfnet_core.response.emor import COMPONENTS, EmorBasis
from training.crfnet2017.network import CRFNet
from training.crfnet2017.train import VALIDATION_BATCH, validation_windows
from training.crfnet2017.windows import Windows, read_splits
from training.export.model_folder import export_options, write_model
from training.export.onnx_graph import WINDOWED, rounded


class ShippedCRFNet(nn.Module):
    """The network as the product runs it: windows of shape (N, 227, 227, 3) in [0, 1] to evidence about 11 weights."""

    def __init__(self, network: CRFNet) -> None:
        super().__init__()
        self.network = network
        self.register_buffer("factor", torch.eye(COMPONENTS))
        self.log_odds = 0.0

    def forward(self, windows: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """Return the network's answers, and the factors and log-odds, which are the same for every window."""
        answers: Tensor = self.network(windows.permute(0, 3, 1, 2))
        factors = self.factor.expand(windows.shape[0], -1, -1)
        return answers, factors, answers[:, : len(UNUSUAL)] * 0 + self.log_odds

    def state_worth(self, answers: Tensor, true: Tensor, known: Tensor) -> None:
        """Fit the evidence to answers and true weights, (N, 11), and the weights of all known responses, (M, 11).

        The log-odds are the mean log likelihood of the known responses, so that an answer says nothing for or against
        the families `UNUSUAL`, which the network does not know.
        """
        scale = torch.cov((answers - true).T) * (DEGREES_OF_FREEDOM - 2) / DEGREES_OF_FREEDOM
        factor = torch.linalg.cholesky(torch.linalg.inv(scale))
        squares = ((answers[:, None] - known) @ factor).square().sum(dim=2)
        likelihoods = (1 + squares / DEGREES_OF_FREEDOM) ** (-(DEGREES_OF_FREEDOM + COMPONENTS) / 2)
        self.factor, self.log_odds = factor.float(), float(likelihoods.mean(dim=1).log().mean())


def load_network(run: Path) -> ShippedCRFNet:
    """Return the best network of a run of the stage regress, its normalizations folded, else raise SystemExit."""
    state = torch.load(run / "best.pt", map_location="cpu", weights_only=True)
    network = CRFNet()
    if state["network"]["head.weight"].shape != network.head.weight.shape:
        raise SystemExit(f"{run}: is a run of the stage classify; export one of the stage regress")
    network.load_state_dict(state["network"])
    return ShippedCRFNet(fold_normalization(network)).eval()


def fold_normalization(network: CRFNet) -> CRFNet:
    """Return the network itself, ready to infer, with each normalization folded into the convolution before it."""
    network.eval()
    for layers in [module for module in network.modules() if isinstance(module, nn.Sequential)]:
        for index, layer in enumerate(layers):
            if isinstance(layer, nn.BatchNorm2d):
                layers[index - 1] = nn.utils.fuse_conv_bn_eval(layers[index - 1], layer)
                layers[index] = nn.Identity()
    return network


def fit_worth(network: ShippedCRFNet, validation: Windows, responses: Tensor) -> float:
    """Fit the evidence of a network to validation windows, and return its mean distance from their true weights."""
    known = torch.from_numpy(EmorBasis.load().project(responses.double().numpy()))
    with torch.inference_mode():
        answers = torch.cat([network.network(part) for part in validation.inputs(VALIDATION_BATCH)]).double()
    true = known[validation.classes]
    network.state_worth(answers, true, known)
    return float((answers - true).norm(dim=1).mean())


def main() -> None:
    """Export the best network of a run."""
    parser = export_options((__doc__ or "").splitlines()[0])
    parser.add_argument("--data", type=Path, required=True, help="folder with dorf and linear")
    options = parser.parse_args()
    network = rounded(load_network(options.run))
    scenes = read_splits(options.data)["validation"]
    print(f"E_est of the validation windows: {fit_worth(network, validation_windows(scenes), scenes.curves):.3f}")
    write_model(network, WINDOWED, options)


if __name__ == "__main__":
    main()
