"""LUT files, OpenColorIO configs and linear plates from an estimated camera response; the command `crfnet`.

cli           the command: exit codes and error lines
arguments     the arguments of its subcommands, which need no numpy
commands      the work of its subcommands: arguments to options, pipeline, output
interruption  signals that end a run
streams       what the command prints to
defaults      constants that several modules share
options       typed options of the pipeline
pipeline      the one way from photographs to files, for the command and for the add-on
output_files  which files an estimate writes, and whether they may be written
staging       a set of files that appears whole or not at all
report        estimates and files in words, as JSON, and as provenance
sheet         an estimate as a picture; calibration_sheet a measured response
luts          the LUT, and its file formats
interchange   responses in the files of other programs
configs       OpenColorIO configs with a plate's colour space
plates        frame sequences, and linear EXR files made of them
movies        movies as sources of frames
"""
