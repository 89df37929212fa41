"""The work of the subcommands of `crfnet`: read the arguments, run `crfnet.pipeline`, print the results.

options      from arguments to the options of the pipeline
each         --each of estimate and linearize
printing     lines, JSON and progress bars
the others   one subcommand each: `run(arguments)`
"""
