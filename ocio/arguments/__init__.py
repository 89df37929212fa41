"""The arguments of each subcommand of `crfnet`: parsed and refused without importing numpy, so that help is quick.

estimate, linearize, config, convert, info, completion    one subcommand each, its options and its examples
parts                                                     options of several subcommands, and the types of their values
"""
