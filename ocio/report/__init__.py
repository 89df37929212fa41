"""Estimates and files in words, as documents and as pictures.

facts        photographs and errors in words, and the provenance that LUT files carry
words        lines for people: of the command and of the add-on
documents    the same for machines, ready for JSON
calibration  a measured response in words, as JSON and as provenance
sheet        the picture of an estimate; calibration_sheet of a measured response: both need matplotlib
"""
