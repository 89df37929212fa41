"""The arguments of each subcommand of `crfnet`: parsed and refused without importing numpy, so that help is quick.

command_line   the parser of all of it
parts          options of several subcommands, and the types of their values
the others     one subcommand each, its options and its examples
"""
