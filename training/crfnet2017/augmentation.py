"""Augmentations of linear light before the response, which the paper has not: with 160 scenes for its 595.

Blends of two scenes, mirroring, transposition, permuted channels, white balance, color matrices and contrast. None
changes what the response does; the strengths are ours.
"""

import torch
from torch import Tensor

#: Part of the windows that are a blend of two scenes.
BLENDED = 0.25

#: Standard deviations: of the gains of white balance and of the exponent of contrast, in stops; and of a color matrix.
GAINS, CONTRAST, MATRIX = 0.4, 0.3, 0.12


def augmented(light: Tensor, other: Tensor, generator: torch.Generator) -> Tensor:
    """Return light (N, 3, 227, 227), blended with `other` in some windows and changed as a whole, float32."""
    count, device = len(light), light.device

    def normal(*shape: int) -> Tensor:
        return torch.randn(count, *shape, device=device, generator=generator)

    def uniform() -> Tensor:
        return torch.rand(count, 1, 1, 1, device=device, generator=generator)

    part = torch.where(uniform() < BLENDED, uniform(), 0)
    light = (1 - part) * light.float() + part * other.float()
    light = torch.where(uniform() < 0.5, light.flip(3), light)
    light = torch.where(uniform() < 0.5, light.transpose(2, 3), light)
    order = torch.rand(count, 3, device=device, generator=generator).argsort(dim=1)
    light = light.gather(1, order[:, :, None, None].expand_as(light))
    matrix = torch.eye(3, device=device) + MATRIX * normal(3, 3)
    matrix = matrix / matrix.sum(dim=2, keepdim=True)  # neutrals stay
    light = torch.einsum("nij,njhw->nihw", torch.exp2(GAINS * normal(3, 1)) * matrix, light).clamp(min=0)
    return light ** torch.exp2(CONTRAST * normal(1, 1, 1))
