"""Camera responses in the files of other programs, read and written.

response_file  a response that was read: its inverse as a LUT, and what the file said of it
calibration    tables over code values from an exposure series: gaps, noise and clipped codes mended, and said so
opencv         OpenCV's calibrated responses, .npy, .yml and .xml
pfstools       the .m files of pfshdrcalibrate
dorf           the text of DoRF, the Database of Response Functions
hugin          the five EMoR parameters of the images of a Hugin project
other_luts     LUT formats that OpenColorIO reads: .csp, .3dl, .lut
files          read or write any of these and the LUT formats of `crfnet.luts`, by suffix
"""
