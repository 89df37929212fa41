"""The network of the CRF-net paper and its two-stage training, to compare with.

windows      draws windows of packed scenes; as a command, writes the pack
pack         scenes, responses and exposures on disk
network      the network of Table 1
stages       loss and validation figure of both stages
recipes      optimizers and learning rates
train        the command that trains; `trainer` is its loop
checkpoints  state of a run; weights of another run or of a model folder
runlog       log.csv and curves.png
export       the command that writes the model folder

Source: Li & Peers, "CRF-net: Single Image Radiometric Calibration using CNNs", CVMP 2017: Table 1 (network), Sec. 3.2
(windows), Sec. 3.3 (synthetic photographs), Sec. 3.4 (classification first, regression after it).
"""
