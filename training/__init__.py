"""Train, measure and export the networks of crfnet_core: the only part of the project that needs PyTorch.

data        responses and scenes: their sources and splits, and the bank made of them
synthesis   simulated cameras and training photographs
network     the photograph network and its training
crfnet2017  the network of the CRF-net paper and its training
export      from a run to a model folder and its card; the library of measured cameras
evaluation  figures of models and baselines, where the response is known
state       a network in training, with the moving average of its weights
provenance  the record of a run: code, data, recipe, seed and versions
"""
