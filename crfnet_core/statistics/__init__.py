"""Sums counted in a window: they depend on the slope and the curvature of the response, and add up over windows.

Two kinds of evidence. (i) Relative gradients of irradiance hardly depend on its level, so how the gradients of
brightness vary with the level shows the slope of f. (ii) At an edge, a sample b mixes the light of its two sides a and
c in the same ratio in R, G and B, but f distorts that ratio by an amount that depends on the level. The difference
between the channels therefore measures the curvature of the inverse response g, whatever the scene.

windows            the windows of a photograph
cues               the table of all cues, the statistics of one window, and their layout
sampling           samples in a row: neighbors, edges and mixtures, at several strides and at half resolution
gradients          histogram, and differences between neighbors at each level
edges              where the middle of an edge lies between its sides
channel_equations  normal equations for the curvature of g, from the differences between channels
candidates         32 candidate responses as tables over the codes
mixing             how well the mixing ratios agree between channels under each candidate
shading            how well the ratios of shaded samples agree between channels under each candidate

The network turns the sums into means: see `training.network.features`.

Source of (ii): Lin, Gu, Yamazaki & Shum, "Radiometric calibration from a single image", CVPR 2004.
"""

from crfnet_core.statistics.cues import COUNTS_OF, CUES, LENGTH, SHAPES, unpack, window_statistics

__all__ = ["COUNTS_OF", "CUES", "LENGTH", "SHAPES", "unpack", "window_statistics"]
