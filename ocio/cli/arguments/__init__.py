"""The command line of `crfnet`: parsed and refused without importing numpy, so that help is quick.

command_line   every subcommand, its options and its examples
parts          options of several subcommands, and the types of their values
"""
