"""Measure a camera's response from raw files and the JPEGs that the camera made of them; needs rawpy and SciPy.

measure       the whole of it on one screen: files in, response and two uncertainties out
files         raw file and JPEG: found by name, read, checked
registration  where the pixels of the JPEG lie in the raw picture
cells         flat places: their raw light and their codes
fit           one response and one color matrix that explain the cells
"""
