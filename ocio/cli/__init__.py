"""The command `crfnet`.

main       exit codes, error lines, and signals that end a run
arguments  the arguments of the subcommands, which need no NumPy
commands   the work of the subcommands: arguments to options, pipeline, output
remedies   what to do about errors, with the options of the command
streams    what the command prints to
"""
