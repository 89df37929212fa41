"""Train, measure and export the networks of crfnet_core: the only part of the project that needs PyTorch.

Both trainings share `state`, the network with the moving average of its weights, and `provenance`, the record of a run.
"""
