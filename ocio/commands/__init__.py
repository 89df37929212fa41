"""What the subcommands of `crfnet` do: read the arguments, run `ocio.pipeline`, show what came of it.

estimate, linearize, config, convert, info    one subcommand each: `run(arguments)`
options                                       from arguments to the options of the pipeline
printing                                      lines, JSON and progress bars
"""
