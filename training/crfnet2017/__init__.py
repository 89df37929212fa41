"""The network of the CRF-net paper and its way of training, to compare with and to train on.

Source: Li & Peers, "CRF-net: Single Image Radiometric Calibration using CNNs", CVMP 2017: Table 1 (network), Sec. 3.2
(windows), Sec. 3.3 (synthetic photographs), Sec. 3.4 (classification first, regression after it).
"""
