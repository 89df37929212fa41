"""Lookup tables: the table itself, and one module per file format.

lut1d     the table, its interpolation in both directions, and the inverse response as a table
rgb_lut   a table for each channel
forward   the response itself as a table, from light to codes
text      the text of a LUT file: numbers and tables, with errors that name the line
spi1d     Sony's .spi1d
cube      the .cube format of Adobe and Resolve
clf       the Academy's Common LUT Format
response  the response of a LUT of its inverse
exposure  the stops that put white at 1 or 18 % gray at 0.18
agreement whether OpenColorIO reads the same in a file
files     read or write a LUT file of any of these formats, by its suffix
"""
