"""The network of Table 1 of the CRF-net paper, for windows of 227 x 227 samples."""

import torch
from torch import Tensor, nn

from crfnet_core.response.emor import COMPONENTS

#: Channels and side of the maps that the last layer is fully connected to.
MAP_CHANNELS, MAP_SIDE = 512, 23


class Bottleneck(nn.Module):
    """A residual block of ResNet-50: convolutions of 1x1, 3x3 (of `inner` channels) and 1x1, beside a shortcut.

    The first convolution and the projection of the shortcut have the stride, as in the ResNet-50 of 2015.
    """

    def __init__(self, channels: int, inner: int, outputs: int, *, stride: int = 1) -> None:
        super().__init__()
        self.branch = nn.Sequential(
            *_normalized(channels, inner, 1, stride),
            nn.ReLU(inplace=True),
            *_normalized(inner, inner, 3, 1),
            nn.ReLU(inplace=True),
            *_normalized(inner, outputs, 1, 1),
        )
        is_projected = stride != 1 or channels != outputs
        self.shortcut = nn.Sequential(*_normalized(channels, outputs, 1, stride)) if is_projected else nn.Identity()

    def forward(self, maps: Tensor) -> Tensor:
        """Return maps (N, outputs, H / stride, W / stride) of maps (N, channels, H, W)."""
        return torch.relu(self.branch(maps) + self.shortcut(maps))


class CRFNet(nn.Module):
    """Windows to 11 EMoR weights (3 864 203 parameters), or to scores of 201 responses: CRF-net paper, Table 1."""

    def __init__(self, outputs: int = COMPONENTS) -> None:
        super().__init__()
        self.body = nn.Sequential(
            nn.Conv2d(3, 64, 7, stride=2, padding=3),
            nn.BatchNorm2d(64),
            nn.ReLU(inplace=True),
            nn.MaxPool2d(3, stride=2, padding=1),
            Bottleneck(64, 64, 256),
            Bottleneck(256, 64, 256),
            Bottleneck(256, 64, 256),
            Bottleneck(256, 128, 512, stride=2),
            Bottleneck(512, 128, MAP_CHANNELS),
            # 7 x 7 in two passes takes a third of the time of one pass in the backward step.
            nn.AvgPool2d((7, 1), stride=1),
            nn.AvgPool2d((1, 7), stride=1),
        )
        self.head = nn.Linear(MAP_CHANNELS * MAP_SIDE * MAP_SIDE, outputs)
        for module in self.body.modules():
            if isinstance(module, nn.Conv2d):
                nn.init.kaiming_normal_(module.weight, mode="fan_out", nonlinearity="relu")
        nn.init.zeros_(self.head.weight)  # the mean response, or equal scores
        nn.init.zeros_(self.head.bias)

    def forward(self, windows: Tensor) -> Tensor:
        """Return (N, outputs) of windows of shape (N, 3, 227, 227) in [0, 1]."""
        maps = self.body(windows * 2 - 1)
        with torch.autocast(maps.device.type, enabled=False):
            outputs: Tensor = self.head(maps.float().flatten(1))
        return outputs


def _normalized(channels: int, outputs: int, size: int, stride: int) -> tuple[nn.Module, nn.Module]:
    """Return a convolution that keeps the side at stride 1, and the normalization of its outputs."""
    convolution = nn.Conv2d(channels, outputs, size, stride=stride, padding=size // 2, bias=False)
    return convolution, nn.BatchNorm2d(outputs)
