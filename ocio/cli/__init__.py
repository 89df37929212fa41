"""The command `crfnet`.

main          exit codes and error lines
arguments     the arguments of the subcommands, which need no NumPy
commands      the work of the subcommands: arguments to options, pipeline, output
remedies      what to do about errors, with the options of the command
interruption  signals that end a run
streams       what the command prints to
"""
