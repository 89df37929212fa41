"""What the subcommands of `crfnet` do: read the arguments, run `crfnet.pipeline`, show what came of it.

options      from arguments to the options of the pipeline
printing     lines, JSON and progress bars
the others   one subcommand each: `run(arguments)`
"""
