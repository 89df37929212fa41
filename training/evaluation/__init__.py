"""Measure models against responses that are known; `training.evaluation` is the command.

`plan` says which photographs are taken, `material` and `camera` take them, `measure` asks every model and baseline for
the response, `cases` keeps the errors, `tables` sums them up, `markdown` and `figures` show them.
"""
