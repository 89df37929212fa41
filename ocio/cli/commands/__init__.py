"""The work of the subcommands of `crfnet`: read the arguments, run `crfnet.pipeline`, print the results.

each         what estimate and linearize share: options of the pipeline, and --each
printing     lines, JSON and progress bars
the others   one subcommand each: `run(arguments)`
"""
