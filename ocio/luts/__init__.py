"""Lookup tables: the table itself, and a module per file format.

lut1d   the table, its arithmetic, and the inverse response as one
text    read the text of a LUT file with care
spi1d   Sony's .spi1d
cube    Iridas' .cube
clf     the Academy's Common LUT Format
files   a LUT file by its suffix
"""
