"""Lookup tables: the table itself, its files, and what is computed from it.

lut1d        the table, its interpolation in both directions, and the inverse response as a table
rgb_lut      a table for each channel
files        the formats that are written: .spi1d, .cube, .clf
opencolorio  LUT files of any format, as OpenColorIO reads them
response     the response from a LUT of its inverse, or from a LUT file of either direction
forward      the response itself as a table, from light to codes
"""
