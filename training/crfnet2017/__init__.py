"""The network of the CRF-net paper and its two-stage training, to compare with.

windows  draws windows of linear scenes, changes their light and renders them
network  the network of Table 1
recipes  optimizers, learning rates and lengths of both stages
train    loss and validation figure of both stages, and the command that trains
export   the command that writes the model folder

Source: Li & Peers, "CRF-net: Single Image Radiometric Calibration using CNNs", CVMP 2017: Table 1, Sec. 3.2 (network,
windows, 11 components), Sec. 3.3 (synthetic photographs; classification first, regression after it).
"""
