"""Train, measure and export the networks of crfnet_core: the only part of the project that needs PyTorch."""
